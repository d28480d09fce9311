"""What all machine elements have in common, and the register of their kinds.

A kind of element is one class in one file: its numbers (the model that texts are read by), its results, and the law
that makes these of those. The file bears the name of the kind, so that a scene with `type = "screw"` loads `screw.py`
and no other: an element that isn't used costs nothing. Nothing else names a kind.

An element stands beside the mechanism, if there is one: its load is its own, and the mechanism doesn't feel it.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import IntEnum
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, get_args, get_origin

import numpy as np
from pydantic import SerializeAsAny, ValidationError, ValidationInfo, WrapValidator
from pydantic_core import InitErrorDetails, PydanticCustomError, PydanticKnownError
from pydantic_core.core_schema import ErrorType

from engine.cycle.measured import Measured
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, bounded
from engine.laws.rounding import EPS, NUDGE
from engine.parts.skeleton import Part
from engine.units.dimensions import described
from engine.words.verdicts import Verdict

Numbers = Mapping[str, np.ndarray]
Columns = dict[str, np.ndarray]

# Roundings of a result's size that an error estimate is made of.
ROUNDING = 16
# Places of curves over a number, and how many diagrams of them are drawn of an element without any of its own.
PLACES, _MOST_PANELS = 201, 4


class Rank(IntEnum):
    """How much a number matters to the engineer: one asked of the machine, a further one, or a check of the results."""

    ANSWER = 0
    FURTHER = 1
    CHECK = 2


class ElementResult(NamedTuple):
    """A result of a law: its name, meaning and unit, the key it needs to be given, whether it may have no value.

    One that is `exact` says yes or no and has no error estimate.
    """

    name: str
    long_name: str
    units: str
    needs: str | None = None
    may_be_undefined: bool = False
    exact: bool = False
    rank: Rank = Rank.ANSWER


class Answers(NamedTuple):
    """What is computed of an element: results and their error estimates by name, and verdicts, of all variants."""

    values: Columns
    errors: Columns
    verdicts: np.ndarray | Verdict = Verdict.OK

    @classmethod
    def of(cls, found: Mapping[str, Measured]) -> "Answers":
        """Results that carry their errors, without a complaint."""
        return cls({name: m.value for name, m in found.items()}, {name: m.error for name, m in found.items()})


class Element(Part):
    """A machine element; a subclass with a `type` of its own registers itself by being defined.

    Attributes
    ----------
    RESULTS : tuple of ElementResult
        Results of this kind; those that need a key which isn't given are left out.
    variants_at_once : int
        For how many variants at a time it is evaluated.
    infinite : Verdict
        On a variant with an infinite result: JAMS where no force or moment moves the element.
    picture : str
        What its diagrams show, in a word that their files' names end with.
    """

    RESULTS: ClassVar[tuple[ElementResult, ...]] = ()
    variants_at_once: ClassVar[int] = 2048
    infinite: ClassVar[Verdict] = Verdict.JAMS
    picture: ClassVar[str] = "results"

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        kind = cls.model_fields.get("type")
        if kind is not None and get_origin(kind.annotation) is Literal:
            _KINDS[get_args(kind.annotation)[0]] = cls

    def results(self) -> tuple[ElementResult, ...]:
        """Results that the element has with what it is given."""
        return tuple(r for r in self.RESULTS if r.needs is None or getattr(self, r.needs) is not None)

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by their names; NaN or infinite where there is none.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
            The element's numbers by their keys, such as "engine.load"; those of the model itself are not used.
        """
        raise NotImplementedError

    def in_order(self, rows: Iterable[np.ndarray]) -> Columns:
        """Results of a law that gives them in the order of RESULTS, by their names."""
        return dict(zip((r.name for r in self.RESULTS), rows, strict=True))

    def evaluate(self, n: Numbers) -> Answers:
        """Results with their error estimates, and verdicts; estimates by nudges unless an element has better ones.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
            As for `values`.
        """
        return Answers(*nudged(self.values, n))

    def own_values(self) -> dict[str, float]:
        """Results of the element with its own numbers."""
        return {name: float(row[0]) for name, row in self._found(self.own_numbers(), 1).items()}

    def over(self, key: str, values: np.ndarray) -> Columns:
        """Results over one of its numbers, all others as they are; NaN where there is none.

        Parameters
        ----------
        key : str
        values : ndarray (variants,)
        """
        n = {own: np.repeat(value, values.size) for own, value in self.own_numbers().items()}
        return self._found(n | {key: np.asarray(values, float)}, values.size)

    def _found(self, n: Numbers, variants: int) -> Columns:
        with np.errstate(all="ignore"):
            found = self.evaluate(n).values
        rows = {r.name: np.broadcast_to(found[r.name], (variants,)) for r in self.results()}
        return {name: np.where(np.isfinite(row), row, math.nan) for name, row in rows.items()}

    def panels(self, given: Numbers = MappingProxyType({})) -> tuple[Panel, ...]:
        """Diagrams that show the element: its results over the first of its numbers, unless it has better ones.

        Parameters
        ----------
        given : mapping of str to ndarray (1,)
            What the machine of its scene gives it, by the keys that `values` knows it by.
        """
        key, number = next(self.numbers_within())
        groups: dict[str, list[str]] = {}
        for result in self.results():
            if not result.exact:
                groups.setdefault(result.units, []).append(result.name)
        span = np.linspace(0.5, 1.5, PLACES) * (number.value or 1.0)
        x = PanelAxis(key.replace("_", " "), described(number.dimension).unit)
        return self.panels_over(key, x, span, [("results", names) for names in groups.values()][:_MOST_PANELS])

    def panels_over(
        self, key: str, x: PanelAxis, values: np.ndarray, groups: Iterable[tuple[str, Sequence[str]]]
    ) -> tuple[Panel, ...]:
        """Results over one of the element's numbers, in one diagram for those of a unit; an upright line as given.

        Parameters
        ----------
        key : str
            Of the number.
        x : PanelAxis
        values : ndarray (places,)
        groups : iterable of (str, sequence of str)
            Words, and names of results.
        """
        found, units = self.over(key, values), {r.name: r.units for r in self.results()}
        given = float(self.own_numbers()[key][0])
        made = []
        for words, names in groups:
            curves = [Curve(name.replace("_", " "), found[name]) for name in names]
            limits = bounded(values, curves, given)
            y = PanelAxis(words, units[names[0]])
            made.append(Panel(x, y, values, curves, (Mark("as given", given, None),), limits=limits))
        return tuple(made)

    def machine_needed(self) -> tuple[str, str]:
        """Key with a dot before it, and words, of what needs a machine with a crank that turns; ("", "") without."""
        return "", ""


_KINDS: dict[str, type[Element]] = {}


@cache
def _modules() -> dict[str, str]:
    """Modules of the engine's own kinds: a kind stands in a file of its name."""
    here = Path(__file__).parent
    files = {path.stem: path for path in here.glob("*/*.py")}
    return {
        kind: f"{__package__}.{path.parent.name}.{kind}"
        for kind, path in sorted(files.items())
        if f'type: Literal["{kind}"]' in path.read_text(encoding="utf8")
    }


def element_kind(name: str) -> type[Element] | None:
    """The kind of element of a name, loaded where it isn't yet; None for one that there isn't.

    Parameters
    ----------
    name : str
        The `type` of an element, such as "screw".
    """
    if name not in _KINDS and name in _modules():
        import_module(_modules()[name])
    return _KINDS.get(name)


def element_kinds() -> dict[str, type[Element]]:
    """All kinds of elements by their names."""
    for name in _modules():
        element_kind(name)
    return dict(sorted(_KINDS.items()))


def _of_its_kind(data: object, handler: Callable, info: ValidationInfo) -> Element:
    """Read an element by the model of its `type`; refused in pydantic's words of a union, which texts are told by."""
    if isinstance(data, Element) or not isinstance(data, Mapping):
        return handler(data)
    if "type" not in data:
        raise PydanticKnownError("union_tag_not_found", {"discriminator": "'type'"})
    kind = element_kind(str(data["type"]))
    if kind is None:
        known = ", ".join(map(repr, element_kinds()))
        tags = {"discriminator": "'type'", "tag": str(data["type"]), "expected_tags": known}
        raise PydanticKnownError("union_tag_invalid", tags)
    try:
        return kind.model_validate(data, context=info.context)
    except ValidationError as refused:
        tag = str(data["type"])
        problems = [_with_tag(problem, tag) for problem in refused.errors(include_url=False)]
        raise ValidationError.from_exception_data(refused.title, problems) from None


def _with_tag(problem: Mapping[str, Any], tag: str) -> InitErrorDetails:
    """A problem whose place begins with the kind of element, as in a union."""
    custom = problem["type"] not in get_args(ErrorType)
    kind = PydanticCustomError(problem["type"], problem["msg"]) if custom else problem["type"]
    return InitErrorDetails(
        type=kind, loc=(tag, *problem["loc"]), input=problem["input"], ctx=dict(problem.get("ctx", {}))
    )


MachineElement = SerializeAsAny[Annotated[Element, WrapValidator(_of_its_kind)]]


def nudged(values: Callable[[Numbers], Columns], n: Numbers) -> tuple[Columns, Columns]:
    """Results with their error estimates, found by changing the numbers a little, in turn.

    An estimate is made of the rounding of each number, as the law passes it on, and that of the result.

    Parameters
    ----------
    values : callable
        Results by name, from the numbers of all variants.
    n : mapping of str to ndarray (variants,)
    """
    table = np.array(list(n.values()))
    count, variants = table.shape
    # All at once, as further variants: first those that stay as they are.
    every = np.repeat(table[:, None, :], count + 1, axis=1)
    k = np.arange(count)
    every[k, k + 1] *= 1.0 + NUDGE
    found, errors = {}, {}
    for name, rows in values(dict(zip(n, every.reshape(count, -1), strict=True))).items():
        parts = np.broadcast_to(rows, every[0].size).reshape(count + 1, variants)
        with np.errstate(invalid="ignore"):
            moved = np.abs(parts[1:] - parts[0])
        moved = np.where(np.isnan(moved), math.inf, moved).sum(axis=0)
        found[name], errors[name] = parts[0], ROUNDING * EPS * (np.abs(parts[0]) + moved / (NUDGE * ROUNDING))
    return found, errors
