"""Base class of the machine elements, and the register of their kinds.

Each kind of element is one class in one file: its input model, and its results, named where they are computed. The
file bears the name of the kind: a scene with `type = "screw"` loads `screw.py` only, so an unused element costs
nothing. No other module lists the kinds.

An element is separate from the mechanism, if there is one: it has its own load, and does not act on the mechanism.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, get_args, get_origin

import numpy as np
from pydantic import SerializeAsAny, TypeAdapter, ValidationInfo, WrapValidator
from pydantic_core import PydanticKnownError

from engine.cycle.measured import Measured
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, bounded
from engine.laws.rounding import EPS, NUDGE
from engine.parts.skeleton import Part
from engine.units.dimensions import described
from engine.words.quantity import Quantity
from engine.words.verdicts import Verdict

Numbers = Mapping[str, np.ndarray]
Columns = dict[str, np.ndarray]

# Relative change of numbers so close to a limit that the usual change would exceed it.
LEAST_NUDGE = 2.0**-13 * NUDGE
# Rounding units of a result's size that its error estimate contains.
ROUNDING = 16
# Samples of a curve over an input number, and the most diagrams drawn for an element that defines none.
PLACES, _MOST_PANELS = 201, 4


def named_in_order(results: Iterable[Quantity], rows: Iterable[np.ndarray]) -> Columns:
    """Rows in the order of the results, by the results' names."""
    return dict(zip((result.name for result in results), rows, strict=True))


def by_name(results: Mapping[Quantity, np.ndarray]) -> Columns:
    """Rows by the names of their results."""
    return {result.name: row for result, row in results.items()}


NamedRows = Iterator[tuple[Quantity, Measured | np.ndarray]]


class Answers(NamedTuple):
    """Results of an element with their error estimates, by name, and the verdicts, for all variants."""

    values: Columns
    errors: Columns
    verdicts: np.ndarray | Verdict = Verdict.OK

    @classmethod
    def of(cls, found: Mapping[str, Measured]) -> "Answers":
        """Results with the error estimates that they carry, verdict OK."""
        return cls({name: m.value for name, m in found.items()}, {name: m.error for name, m in found.items()})


class Element(Part):
    """A machine element; defining a subclass with its own `type` registers it.

    Attributes
    ----------
    variants_at_once : int
        Number of variants evaluated in one call.
    infinite : Verdict
        Verdict on a variant with an infinite result, such as JAMS if no force or torque moves the element.
    picture : str
        Word for the contents of its diagrams, with which the names of their files end.
    """

    variants_at_once: ClassVar[int] = 2048
    infinite: ClassVar[Verdict] = Verdict.NOT_FINITE
    picture: ClassVar[str] = "results"

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        kind = cls.model_fields.get("type")
        if kind is not None and get_origin(kind.annotation) is Literal:
            _KINDS[get_args(kind.annotation)[0]] = cls

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants, with their descriptions; NaN or infinite where undefined.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
            The element's numbers by key, such as "engine.load"; the model's own numbers are not used.
        """
        raise NotImplementedError

    @cached_property
    @np.errstate(all="ignore")
    def results(self) -> tuple[Quantity, ...]:
        """Results available with the keys given, as named with the element's own numbers."""
        return tuple(result for result, _ in self.named(self.own_numbers()))

    def values(self, n: Numbers) -> dict[str, Measured | np.ndarray]:
        """Results of a set of variants by name; parameters as for `named`."""
        return by_name(dict(self.named(n)))

    def evaluate(self, n: Numbers) -> Answers:
        """Results with their error estimates, and verdicts; `nudged` gives the estimates unless overridden.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
            As for `named`.
        """
        return Answers(*nudged(self.values, n))

    def own_values(self) -> dict[str, float]:
        """Results with the element's own numbers."""
        return {name: float(row[0]) for name, row in self._found(self.own_numbers(), 1).items()}

    def over(self, key: str, values: np.ndarray) -> Columns:
        """Results over one of the element's numbers, all others unchanged; NaN where undefined.

        Parameters
        ----------
        key : str
            Key of the number.
        values : ndarray (variants,)
        """
        n = {own: np.repeat(value, values.size) for own, value in self.own_numbers().items()}
        return self._found(n | {key: np.asarray(values, float)}, values.size)

    def _found(self, n: Numbers, variants: int) -> Columns:
        with np.errstate(all="ignore"):
            rows = self.evaluate(n).values.items()
        return {name: np.broadcast_to(np.where(np.isfinite(row), row, math.nan), (variants,)) for name, row in rows}

    def panels(self) -> tuple[Panel, ...]:
        """Diagrams of the element; by default its results over the first of its numbers.

        Kinds that a machine can drive take what that machine supplies as an optional argument.
        """
        key, number = next(self.numbers_within())
        groups: dict[str, list[str]] = {}
        for result in self.results:
            if not result.exact:
                groups.setdefault(result.units, []).append(result.name)
        span = np.linspace(0.5, 1.5, PLACES) * (number.value or 1.0)
        x = PanelAxis(key.replace("_", " "), described(number.dimension).unit)
        shown = [(PanelAxis("results", units), names) for units, names in groups.items()]
        return self.panels_over(key, x, span, shown[:_MOST_PANELS])

    def panels_over(
        self, key: str, x: PanelAxis, values: np.ndarray, groups: Iterable[tuple[PanelAxis, Sequence[str]]]
    ) -> tuple[Panel, ...]:
        """Results over one of the element's numbers, one diagram for each group; a vertical line marks the given value.

        Parameters
        ----------
        key : str
            Key of the number.
        x : PanelAxis
        values : ndarray (samples,)
        groups : iterable of (PanelAxis, sequence of str)
            The y axis, and names of results in its unit.
        """
        found = self.over(key, values)
        given = float(self.own_numbers()[key][0])
        made = []
        for y, names in groups:
            curves = [Curve(name.replace("_", " "), found[name]) for name in names]
            limits = bounded(values, curves, given)
            made.append(Panel(x, y, values, curves, (Mark("as given", given, None),), limits=limits))
        return tuple(made)

    def machine_needed(self) -> tuple[str, str]:
        """Key (with a leading dot) and name of a part that needs a machine with a rotating crank; ("", "") if none."""
        return "", ""


_KINDS: dict[str, type[Element]] = {}


@cache
def _modules() -> dict[str, str]:
    """Modules of the engine's own kinds: each is in a file of its name."""
    here = Path(__file__).parent
    files = {path.stem: path for path in here.glob("*/*.py")}
    return {
        kind: f"{__package__}.{path.parent.name}.{kind}"
        for kind, path in sorted(files.items())
        if f'type: Literal["{kind}"]' in path.read_text(encoding="utf8")
    }


def element_kind(name: str) -> type[Element] | None:
    """Class of a kind of element, loaded if necessary; None if there is no such kind.

    Parameters
    ----------
    name : str
        The `type` of an element, such as "screw".
    """
    if name not in _KINDS and name in _modules():
        import_module(_modules()[name])
    return _KINDS.get(name)


def element_kinds() -> dict[str, type[Element]]:
    """All kinds of elements by name."""
    for name in _modules():
        element_kind(name)
    return dict(sorted(_KINDS.items()))


def _of_its_kind(data: object, handler: Callable, info: ValidationInfo) -> Element:
    """Read an element by the model of its `type`; raise pydantic's errors of a union, which the reports translate."""
    if isinstance(data, Element) or not isinstance(data, Mapping):
        return handler(data)
    if "type" not in data:
        raise PydanticKnownError("union_tag_not_found", {"discriminator": "'type'"})
    tag = str(data["type"])
    kind = element_kind(tag)
    if kind is None:
        known = ", ".join(map(repr, element_kinds()))
        raise PydanticKnownError("union_tag_invalid", {"discriminator": "'type'", "tag": tag, "expected_tags": known})
    return _tagged(kind).validate_python({tag: data}, context=info.context)[tag]


@cache
def _tagged(kind: type[Element]) -> TypeAdapter[dict[str, Element]]:
    """Reader of an element by its tag, with which locations of its errors begin, as in a union."""
    return TypeAdapter(dict[str, kind])


MachineElement = SerializeAsAny[Annotated[Element, WrapValidator(_of_its_kind)]]


def nudged(values: Callable[[Numbers], Columns], n: Numbers, nudge: float = NUDGE) -> tuple[Columns, Columns]:
    """Results with error estimates from the relative change of each number in turn.

    An estimate sums the rounding of each number, propagated through the law, and the rounding of the result. Where a
    changed number leaves a result undefined, it is changed by less.

    Parameters
    ----------
    values : callable
        Returns the results by name for the numbers of all variants.
    n : mapping of str to ndarray (variants,)
    nudge : float
        The relative change.
    """
    table = np.array(list(n.values()))
    count, variants = table.shape
    # One call for all, as additional variants; the first copy is unchanged.
    every = np.repeat(table[:, None, :], count + 1, axis=1)
    k = np.arange(count)
    every[k, k + 1] *= 1.0 + nudge
    found, errors = {}, {}
    for name, rows in values(dict(zip(n, every.reshape(count, -1), strict=True))).items():
        parts = np.broadcast_to(rows, every[0].size).reshape(count + 1, variants)
        with np.errstate(invalid="ignore", divide="ignore"):
            # If a pole, such as a resonance, is nearer than the change, the result's reciprocal is linear instead.
            steeper = np.where(parts[1:] != 0.0, np.fmax(np.abs(parts[0] / parts[1:]), 1.0), 1.0)
            moved = np.abs(parts[1:] - parts[0]) * steeper
        moved = np.where(np.isnan(moved), math.inf, moved).sum(axis=0)
        found[name], errors[name] = parts[0], ROUNDING * EPS * (np.abs(parts[0]) + moved / (nudge * ROUNDING))
    lost = {name for name, row in errors.items() if (np.isinf(row) & np.isfinite(found[name])).any()}
    if lost and nudge == NUDGE:
        closer = nudged(values, n, LEAST_NUDGE)[1]
        errors |= {name: np.where(np.isinf(errors[name]), closer[name], errors[name]) for name in lost}
    return found, errors
