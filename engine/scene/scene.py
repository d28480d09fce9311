"""A scene: one machine, whole, and the numbers in it by their paths."""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Annotated, NamedTuple, get_args

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from engine.elements.elastic_drives.machine_drive_element import MachineDrive
from engine.elements.element_models import MachineElement
from engine.elements.governors.governor_elements import governs_machine
from engine.parts.actions import ForceAction, MomentAction, Spring
from engine.parts.couplings import Coupling
from engine.parts.cylinders import CylinderAction
from engine.parts.driving_cams import DrivingCam
from engine.parts.driving_gears import NoncircularWheel, Pinion, Rack
from engine.parts.formulas.by_formula import FormulaNumber
from engine.parts.pair_friction import PairFriction
from engine.parts.regimes import Regime
from engine.parts.second_inputs import SecondInput
from engine.parts.skeleton import (
    AcceleratedBase,
    Acceleration,
    Balance,
    Body,
    CrankInput,
    DimensionMark,
    Flywheel,
    FreeLink,
    Group,
    Guide,
    Mode,
    Name,
    Near,
    Part,
    PlainText,
    Point,
    Shaft,
    SliderInput,
)
from engine.parts.wanted_motion import WantedMotion


class SceneError(ValueError):
    """A scene that is refused; `problems` holds (path, message) pairs in the mechanic's words."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(f"{path}: {message}" if path else message for path, message in problems))


# What a scene of machine elements alone may have.
_ALONE = {"title", "source", "elements"}


_SINGULAR = {"bodies": "body"}


class Scene(Part):
    """One machine: geometry, input, structural groups, bodies, and what acts on it.

    Groups may stand in any order; free `links` make up groups of any class, whose assembly mode `near` tells. `gravity`
    acts along −y, and the `base` may be accelerated. Without `inertia_in_reactions`, for slow machines, reactions are
    those of the acting forces alone; what else is computed keeps its inertia. `source` says where the numbers come
    from. What is `wanted` of the motion is compared with it. A scene of machine elements alone has no input.
    """

    title: PlainText = ""
    source: PlainText = ""
    gravity: Acceleration = 0.0
    base: AcceleratedBase | None = None
    points: dict[Name, Point] = {}
    guides: dict[Name, Guide] = {}
    input: Annotated[CrankInput | SliderInput, Field(discriminator="type")] | None
    inputs: dict[Name, SecondInput] = {}
    groups: dict[Name, Group] = {}
    links: dict[Name, FreeLink] = {}
    near: dict[Name, Near] = {}
    shafts: dict[Name, Shaft] = {}
    noncircular_wheels: dict[Name, NoncircularWheel] = {}
    racks: dict[Name, Rack] = {}
    pinions: dict[Name, Pinion] = {}
    cams: dict[Name, DrivingCam] = {}
    couplings: dict[Name, Coupling] = {}
    bodies: dict[Name, Body] = {}
    forces: dict[Name, ForceAction] = {}
    moments: dict[Name, MomentAction] = {}
    springs: dict[Name, Spring] = {}
    cylinders: dict[Name, CylinderAction] = {}
    flywheel: Flywheel | None = None
    friction: dict[Name, PairFriction] = {}
    inertia_in_reactions: bool = True
    balance: Balance | None = None
    regimes: dict[Name, Regime] = {}
    wanted: dict[Name, WantedMotion] = {}
    elements: dict[Name, MachineElement] = {}

    def __repr__(self) -> str:
        title = f" {self.title!r}" if self.title else ""
        drive = [f"input {self.input.link}"] if self.input else []
        groups = [f"{group.type} {name}" for name, group in self.groups.items()]
        others = ("links", "bodies", "forces", "moments", "springs", "cylinders", "regimes", "elements")
        held = {key: len(getattr(self, key)) for key in others}
        counted = [f"{n} {key if n > 1 else _SINGULAR.get(key, key[:-1])}" for key, n in held.items() if n]
        return f"<Scene{title}: {', '.join([*drive, *groups, *counted])}>"

    __str__ = __repr__

    @model_validator(mode="before")
    @classmethod
    def _may_be_elements_alone(cls, data: object) -> object:
        if isinstance(data, dict) and data.get("elements") and data.keys() <= _ALONE:
            return {**data, "input": None}
        return data

    @model_validator(mode="after")
    def _mechanism_has_an_input(self) -> "Scene":
        fields = {key: field for key, field in type(self).model_fields.items() if key not in {*_ALONE, "input"}}
        rest = any(getattr(self, key) != field.default for key, field in fields.items())
        if self.input is None and (rest or not self.elements):
            raise ValueError("input is missing: only machine elements do without a mechanism")
        turns = isinstance(self.input, CrankInput) and self.input.start is None
        for name, element in self.elements.items():
            if getattr(element, "machine_at", None) is not None and not turns:
                raise ValueError(f"elements.{name}.machine_at: only a crank that turns fully excites a train")
            if isinstance(element, MachineDrive) and not turns:
                raise ValueError(f"elements.{name}: only a crank that turns fully is driven through an elastic shaft")
        return self

    @model_validator(mode="after")
    def _governed_machine_turns(self) -> "Scene":
        turns = isinstance(self.input, CrankInput) and self.input.start is None
        for name, element in self.elements.items():
            if governs_machine(element) and not turns:
                raise ValueError(
                    f"elements.{name}.engine.machine: the scene has no crank that turns fully; give it one, or leave "
                    "machine out and give the engine's inertia"
                )
        return self


class SceneNumber(NamedTuple):
    """A number of a scene: its value (SI), its dimension, and the limits or choices it must keep."""

    value: float
    dimension: str
    limits: tuple[Gt | Ge | Lt | Le, ...]
    choices: tuple[float, ...] = ()


def _marks(annotation: object, metadata: list) -> list:
    """All marks in a field's annotation, those inside optionals too."""
    found = []
    for mark in metadata:
        found += mark.metadata if isinstance(mark, FieldInfo) else [mark]
    for inner in get_args(annotation):
        found += _marks(inner, list(getattr(inner, "__metadata__", ())))
    return found


@cache
def _marked(kind: type[Part], key: str) -> tuple[str | None, tuple]:
    """Dimension of a number that a kind of part has, and its limits."""
    field = kind.model_fields[key]
    marks = _marks(field.annotation, field.metadata)
    dimension = next((str(m) for m in marks if isinstance(m, DimensionMark)), None)
    return dimension, tuple(m for m in marks if isinstance(m, (Gt, Ge, Lt, Le)))


def _walk(part: Part, path: str) -> Iterator[tuple[str, SceneNumber]]:
    if isinstance(part, FormulaNumber):
        yield path, SceneNumber(part.value, part.dimension, ())
        return
    for key, field in type(part).model_fields.items():
        value = getattr(part, key)
        here = f"{path}.{key}" if path else key
        if isinstance(value, Part):
            yield from _walk(value, here)
        elif isinstance(value, dict):
            for name, inner in value.items():
                yield from _walk(inner, f"{here}.{name}")
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            dimension, limits = _marked(type(part), key)
            if dimension is not None:
                yield here, SceneNumber(float(value), dimension, limits)
            elif field.annotation == Mode:
                yield here, SceneNumber(float(value), "number", (), get_args(Mode))


def scene_numbers(scene: Scene) -> dict[str, SceneNumber]:
    """Every number of a scene that a study may vary, by its path, such as "groups.rod.first.length".

    Entries of tables, counts (revolutions, arms) and numbers that the scene doesn't give are not among them.
    """
    return dict(_walk(scene, ""))


def within_limits(number: SceneNumber, values: np.ndarray) -> np.ndarray:
    """Which values keep the number's limits and are finite; an assembly mode must be +1 or −1.

    Parameters
    ----------
    number : SceneNumber
    values : ndarray
        Values in SI units, any shape.
    """
    keep = np.isin(values, number.choices) if number.choices else np.isfinite(values)
    for limit in number.limits:
        match limit:
            case Gt(gt=bound):
                keep &= values > bound
            case Ge(ge=bound):
                keep &= values >= bound
            case Lt(lt=bound):
                keep &= values < bound
            case Le(le=bound):
                keep &= values <= bound
    return keep


class Numbers(Mapping[str, float | np.ndarray]):
    """The numbers of a scene for a set of variants: those that vary as arrays, all others as floats.

    Parameters
    ----------
    fixed : mapping of path to SceneNumber
        All numbers of the scene, from `scene_numbers`.
    varied : mapping of path to ndarray (variants,)
        Values in SI units; every path must be a number of the scene.
    """

    def __init__(self, fixed: Mapping[str, SceneNumber], varied: Mapping[str, np.ndarray]) -> None:
        self._fixed, self._varied = fixed, varied

    def __getitem__(self, path: str) -> float | np.ndarray:
        if path in self._varied:
            return self._varied[path]
        # As NumPy's number, so that what overflows or is divided by zero becomes inf or NaN, as in an array.
        return np.float64(self._fixed[path].value)

    def with_values(self, values: Mapping[str, np.ndarray]) -> "Numbers":
        """The same numbers with some of them replaced."""
        return Numbers(self._fixed, {**self._varied, **values})

    def on_the_way(self, share: float | np.ndarray) -> "Numbers":
        """Numbers at a share of the way from the scene's own to these; choices are made at once.

        Parameters
        ----------
        share : float or ndarray (variants,)
        """
        return Numbers(
            self._fixed,
            {
                path: values if self._fixed[path].choices else self._fixed[path].value * (1.0 - share) + values * share
                for path, values in self._varied.items()
                if path in self._fixed
            },
        )

    def of_variants(self, chosen: np.ndarray) -> "Numbers":
        """The numbers of some of the variants.

        Parameters
        ----------
        chosen : ndarray of int or bool
            Index into the variants.
        """
        return Numbers(self._fixed, {path: values[chosen] for path, values in self._varied.items()})

    def __iter__(self) -> Iterator[str]:
        return iter(self._fixed)

    def __len__(self) -> int:
        return len(self._fixed)
