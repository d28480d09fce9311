"""A scene of machine elements only, prepared for evaluation; and the choice between it and a machine."""

from collections.abc import Iterable, Mapping

import numpy as np

from engine import warnings
from engine.machine.checks import check_scene, given_numbers, names_of
from engine.machine.elements.asked_elements import AskedElements, element_summaries
from engine.machine.machine import Machine
from engine.machine.results import AskError, Outcome, asked_text, blank
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.words.glossary import did_you_mean
from engine.words.quantity import Quantity
from engine.words.verdicts import Verdict


def made_ready(
    scene: Scene,
    summaries: Iterable[str] = (),
    fields: Iterable[str] = (),
    varied: Iterable[str] = (),
    positions: int = 720,
    dtype: type = np.float64,
    accuracy: float | None = None,
) -> "Machine | ElementsAlone":
    """Prepare a scene with its requested quantities, with a mechanism or with machine elements only.

    Parameters
    ----------
    scene : Scene
    summaries, fields, varied : iterable of str
    positions : int
    dtype : float64 or float32
        All as in `Machine`; elements are computed in float64, once for each variant.
    accuracy : float, optional
        Permitted error of every summary, relative to its magnitude.

    Raises
    ------
    SceneError, AskError
        As in `Machine`.
    """
    if scene.input is None:
        return ElementsAlone(scene, summaries, fields, varied)
    return Machine(scene, summaries, fields, varied, positions, dtype, accuracy)


class ElementsAlone:
    """Machine elements without a mechanism, with the interface of a `Machine` except for fields.

    Parameters
    ----------
    scene : Scene
        Without an input.
    summaries, fields : iterable of str
        Names from `available_summaries`; there are no fields.
    varied : iterable of str
        Paths of the scene's numbers whose values are passed to `evaluate`.

    Raises
    ------
    AskError
        A requested quantity doesn't exist.

    Examples
    --------
    >>> from engine import ElementsAlone, Scene
    >>> scene = Scene.model_validate({"elements": {"jack": {
    ...     "type": "screw", "load": "6.4 kN", "mean_diameter": "30 mm", "pitch": "4 mm", "starts": 2,
    ...     "thread": "square", "friction": 0.08, "collar_diameter": "40 mm", "collar_friction": 0.08,
    ... }}})
    >>> outcome = ElementsAlone(scene, ["jack.raise_moment"]).evaluate({})
    >>> round(float(outcome.summaries["jack.raise_moment"][0]), 2)
    26.18
    """

    dtype = np.dtype(np.float64)
    has_regimes = False
    mechanics = None
    available_fields: Mapping[str, Quantity] = {}
    # Elements have no positions; this single one is a placeholder.
    nodes = np.zeros(1)

    def __init__(
        self, scene: Scene, summaries: Iterable[str] = (), fields: Iterable[str] = (), varied: Iterable[str] = ()
    ) -> None:
        check_scene(scene)
        self.scene, self.varied = scene, names_of(varied)
        self.asked_summaries, self.asked_fields = [*names_of(summaries)], []
        self._limits = scene_numbers(scene)
        for path in self.varied:
            if path not in self._limits:
                raise AskError(f"{path!r} is not a number of this scene; {did_you_mean(path, self._limits)}")
        for name in fields:
            raise AskError(f"{name!r}: machine elements have no fields; a scene with an [input] has")
        known = self.available_summaries
        for name in self.asked_summaries:
            if name not in known:
                hint = did_you_mean(name, known)
                raise AskError(f"{name!r} is not a summary of this scene, which has only machine elements; {hint}")
        self._asked = AskedElements(scene, self.asked_summaries)
        self._warnings = warnings.asked_warnings.AskedWarnings(scene, self.asked_summaries, _has_nothing)

    def __repr__(self) -> str:
        return asked_text(self)

    @property
    def elements(self) -> tuple[str, ...]:
        """Elements with requested summaries."""
        return tuple(self._asked.elements)

    @property
    def groups(self) -> tuple[str, ...]:
        """Paths of the elements, in the order of the indices in `Outcome.status_group`."""
        return tuple(f"elements.{name}" for name in self.scene.elements)

    @property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary of this scene."""
        of_warnings = warnings.asked_warnings.warning_summaries(self.scene, _has_nothing)
        return {q.name: q for q in (*element_summaries(self.scene), *of_warnings)}

    @property
    def numbers_kept(self) -> int:
        """Numbers stored per variant during its evaluation."""
        return len(self._limits)

    def source(self) -> str:
        """Source text of the laws."""
        return self._asked.text

    def new_buffer(self, variants: int) -> np.ndarray:
        """Empty memory for fields, for a number of variants."""
        return np.empty((0, variants, self.nodes.size))

    def evaluate(
        self, varied: Mapping[str, np.ndarray], drop: np.ndarray | None = None, buffer: np.ndarray | None = None
    ) -> Outcome:
        """Evaluate a set of variants.

        Parameters
        ----------
        varied : mapping of path to ndarray (variants,)
            As in `Machine.evaluate`.
        drop : ndarray (variants,) of bool, optional
            Variants not to evaluate; their status is DROPPED.
        buffer : ndarray, optional
            Unused, as there are no fields.

        Raises
        ------
        AskError
            The paths differ from the varied paths.
        """
        arrays, status = given_numbers(self._limits, self.varied, varied, drop)
        keep, outcome = np.flatnonzero(status == Verdict.OK), blank(status, self.asked_summaries, {})
        numbers = Numbers(self._limits, arrays).of_variants(keep)
        if keep.size:
            self._asked.fill(outcome, keep, numbers, self.groups)
        self._warnings.fill(outcome.status, outcome.summaries, outcome.errors, Numbers(self._limits, arrays))
        known = self.available_summaries
        return outcome._replace(units={name: known[name].units for name in self.asked_summaries})


def _has_nothing(name: str) -> bool:
    """Warnings on machine elements read numbers of the scene only."""
    return False
