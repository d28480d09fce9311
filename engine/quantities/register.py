"""The available quantities of a machine: fields, curves over the positions; and summaries, one number per variant."""

from collections.abc import Callable, Iterable, Iterator
from functools import cached_property, partial
from typing import NamedTuple, TypeVar

from engine.graph.nodes import Node
from engine.mechanism.mechanics import Mechanics
from engine.parts.skeleton import CrankInput
from engine.quantities.expressions import (
    Average,
    Expression,
    Followed,
    Integral,
    RootIntegral,
    greatest,
    least,
    length_of_range,
    nodes_of,
    of_root,
    peak,
    place_of,
    sqrt,
    square_of,
)
from engine.scene.load_formulas import NOTHING_REPEATS, time_dependent
from engine.scene.scene import Scene
from engine.words.quantity import STATISTICS, Quantity, Rank


class InputUnits(NamedTuple):
    """Units that depend on the input: of its coordinate q, of reduced inertia and moment, and of 1/q.

    `symbols` are those of its coordinate, of its speed, and of reduced moments.
    """

    q: str
    inertia: str
    moment: str
    per_q: str
    symbols: tuple[str, str, str]

    @classmethod
    def of(cls, scene: Scene) -> "InputUnits":
        """Units for a scene's input: angle and moments for a crank, displacement and forces for a slider."""
        if isinstance(scene.input, CrankInput):
            return cls("rad", "kg m2", "N m", "rad-1", ("φ", "ω", "M"))
        return cls("m", "kg", "N", "m-1", ("q", "v", "F"))

    @property
    def speed(self) -> str:
        """Unit of the input speed."""
        return f"{self.q} s-1"

    @property
    def acceleration(self) -> str:
        """Unit of the input acceleration."""
        return f"{self.q} s-2"


def drive_words(scene: Scene) -> str:
    """Name of the drive torque or force for constant input speed."""
    return f"drive {'torque' if isinstance(scene.input, CrankInput) else 'force'} for constant speed"


Known = TypeVar("Known")


def known(found: Known) -> Callable[[], Known]:
    """Wrap an existing curve or expression as the function that a field or summary takes."""
    return lambda: found


class Field(NamedTuple):
    """A curve over the positions.

    Attributes
    ----------
    name, long_name, units : str
        Name, meaning, SI unit in CF spelling.
    curve : callable
        Makes the node, or followed curve, on request.
    symbol : str
        Textbook symbol.
    answers : tuple of str
        Statistics of interest to an engineer, such as "peak".
    rank : Rank
        `Rank.FURTHER` for derivatives and components of other fields, and repetitions of them.
    """

    name: str
    long_name: str
    units: str
    curve: Callable[[], Node | Followed]
    symbol: str = ""
    answers: tuple[str, ...] = ()
    rank: Rank = Rank.ANSWER

    @classmethod
    def of(cls, quantity: Quantity, curve: Callable[[], Node | Followed], answers: tuple[str, ...] = ()) -> "Field":
        """The field that a quantity describes."""
        return cls(quantity.name, quantity.long_name, quantity.units, curve, quantity.symbol, answers)

    @property
    def quantity(self) -> Quantity:
        """Its description."""
        return Quantity(*self[:3], symbol=self.symbol, rank=self.rank)


class Summary(NamedTuple):
    """A number per variant.

    Attributes
    ----------
    name, long_name, units : str
    expression : callable
        Makes the expression on request.
    symbol : str
        Textbook symbol.
    may_be_undefined : bool
        Whether NaN is a valid result, not a failure.
    rank : Rank
    """

    name: str
    long_name: str
    units: str
    expression: Callable[[], Expression]
    symbol: str = ""
    may_be_undefined: bool = False
    rank: Rank = Rank.FURTHER

    @property
    def quantity(self) -> Quantity:
        """Its description."""
        return Quantity(*self[:3], self.may_be_undefined, symbol=self.symbol, rank=self.rank)


Declared = Iterator[Field | Summary]
answer_summary, check_summary = (partial(Summary, rank=rank) for rank in (Rank.ANSWER, Rank.CHECK))
detail = partial(Field, rank=Rank.FURTHER)


def ranked_summary(asked: bool) -> Callable[..., Summary]:
    """Constructor of summaries, ranked as main results if asked for."""
    return answer_summary if asked else Summary


def mean(mechanics: Mechanics, curve: Node | Followed) -> Expression:
    """Mean of a curve over the range of the input."""
    if isinstance(curve, Followed):
        return Average(curve, 1)
    square = square_of(curve)
    whole = Integral(curve) if square is None else RootIntegral(square)
    return of_root(curve, whole / length_of_range(mechanics.first, mechanics.last))


def mean_square(mechanics: Mechanics, curve: Node | Followed) -> Expression:
    """Mean of the square of a curve over the range of the input."""
    return Average(curve, 2) if isinstance(curve, Followed) else mean(mechanics, square_of(curve) or curve * curve)


def statistic_summaries(field: Field, mechanics: Mechanics) -> Iterable[Summary]:
    """Statistics of a field as summaries: FIELD.min, FIELD.max, FIELD.mean and so on."""
    q = InputUnits.of(mechanics.scene).q
    curve, stem = field.curve(), f"{field.symbol}{',' if '_' in field.symbol else '_'}"
    declared = {
        "min": (field.units, lambda: least(curve)),
        "max": (field.units, lambda: greatest(curve)),
        "range": (field.units, lambda: greatest(curve) - least(curve)),
        "amplitude": (field.units, lambda: (greatest(curve) - least(curve)) / 2),
        "peak": (field.units, lambda: peak(curve)),
        "mean": (field.units, lambda: mean(mechanics, curve)),
        "rms": (field.units, lambda: sqrt(mean_square(mechanics, curve))),
        "min_at": (q, lambda: place_of(curve, "least")),
        "max_at": (q, lambda: place_of(curve, "greatest")),
    }
    return [
        Summary(
            f"{field.name}.{key}",
            f"{STATISTICS[key]} {field.long_name}",
            units,
            expression,
            symbol=f"{stem}{key}" if field.symbol and units == field.units else "",
            rank=Rank.ANSWER if key in field.answers else Rank.FURTHER,
        )
        for key, (units, expression) in declared.items()
    ]


class Register:
    """All quantities of a machine, by name.

    Parameters
    ----------
    mechanics : Mechanics
    declared : iterable of Field or Summary

    Attributes
    ----------
    fields, summaries : dict
        By name; statistics of fields are not among the summaries, but `summary` makes them.
    """

    def __init__(self, mechanics: Mechanics, declared: Iterable[Field | Summary]) -> None:
        self.mechanics = mechanics
        self.fields: dict[str, Field] = {}
        self.summaries: dict[str, Summary] = {}
        answers: list[str] = []
        for quantity in declared:
            known = self.fields if isinstance(quantity, Field) else self.summaries
            known[quantity.name] = quantity
            if isinstance(quantity, Field):
                answers += [f"{quantity.name}.{statistic}" for statistic in quantity.answers]
            elif quantity.rank == Rank.ANSWER:
                answers.append(quantity.name)
        self._answers = answers
        self._statistics: dict[str, Summary] = {}

    @cached_property
    def _timed(self) -> list[str]:
        """Loads that depend on time, so that the machine has no cycle at constant speed."""
        return time_dependent(self.mechanics.scene) if self.mechanics.has_cycle else []

    def why_not(self, name: str) -> str | None:
        """Reason why a quantity is undefined over the cycle: a load depends on time; None if it is defined.

        Parameters
        ----------
        name : str
            A field, a summary or a statistic of a field.
        """
        if not self._timed:
            return None
        field, summary = self.fields.get(name), self.summary(name)
        if field is None and summary is None:
            return None
        if not self.mechanics.depends_on_time(nodes_of(field.curve() if summary is None else summary.expression())):
            return None
        return (
            f"{name!r}: a load depends on time ({', '.join(self._timed)}), so at constant speed {NOTHING_REPEATS}; ask "
            "for results of a run, or give the load over the crank's angle"
        )

    @property
    def answers(self) -> tuple[str, ...]:
        """Summaries and statistics of fields of interest to an engineer, most important first."""
        return tuple(name for name in self._answers if self.why_not(name) is None)

    @property
    def available_fields(self) -> dict[str, Field]:
        """Fields that are defined over the cycle, by name."""
        return {name: field for name, field in self.fields.items() if self.why_not(name) is None}

    def summary(self, name: str) -> Summary | None:
        """A summary, or a statistic of a field; None for an unknown name."""
        if name in self.summaries:
            return self.summaries[name]
        field, _, statistic = name.rpartition(".")
        if statistic not in STATISTICS or field not in self.fields:
            return None
        if name not in self._statistics:
            self._statistics |= {s.name: s for s in statistic_summaries(self.fields[field], self.mechanics)}
        return self._statistics[name]
