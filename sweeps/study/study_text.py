"""The keys of a study's text: a scene, what varies in it, and what is asked of it."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from engine import PlainNumber, PlainText, Scene, ScenePart, first_last_count


class Range(ScenePart):
    """`count` values from `from` to `to`, ends included; a grid axis."""

    start: Annotated[float | str, Field(alias="from")]
    stop: Annotated[float | str, Field(alias="to")]
    count: Annotated[int, Field(ge=1)]
    spacing: Literal["linear", "log"] = "linear"


class Listing(ScenePart):
    """Explicit values; a grid axis."""

    values: Annotated[list[float | str], Field(min_length=1)]


class Between(ScenePart):
    """Anywhere between two values, drawn by the study's sampling together with all others of its kind."""

    low: float | str
    high: float | str
    spacing: Literal["linear", "log"] = "linear"


class Sampling(ScenePart):
    """How the numbers given by `low` and `high` are drawn."""

    method: Literal["random", "sobol", "latin"] = "sobol"
    count: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)] = 0


class Outputs(ScenePart):
    """What is kept: summaries (numbers per variant), fields (rows over the crank angle), derivatives of summaries.

    A derivative is asked for as "excess_work by input.length".
    """

    summaries: list[str] = []
    fields: list[str] = []
    derivatives: list[str] = []


class Best(ScenePart):
    """Which variant answers the study's question: the least or greatest of a summary, among those that meet `where`."""

    minimise: str | None = None
    maximise: str | None = None
    where: str | None = None

    @model_validator(mode="after")
    def _one_goal(self) -> "Best":
        if (self.minimise is None) == (self.maximise is None):
            raise ValueError("give either minimise or maximise, the name of a summary")
        return self

    @property
    def goal(self) -> str:
        """Name of the summary that decides."""
        return self.maximise if self.minimise is None else self.minimise

    @property
    def sign(self) -> float:
        """+1 to minimise, −1 to maximise."""
        return -1.0 if self.minimise is None else 1.0

    @property
    def word(self) -> str:
        """Whether the minimum or the maximum is sought."""
        return "maximum" if self.minimise is None else "minimum"


def _listed(value: object) -> object:
    """A single text as a list of one."""
    return [value] if isinstance(value, str) else value


Texts = Annotated[list[str], BeforeValidator(_listed)]


class Optimise(ScenePart):
    """What a search looks for: expressions over parameters and summaries, the conditions they meet, and the way.

    Without `minimise` and `maximise` the goal is that of the study's `best`; without `method` it is differential
    evolution for one objective and NSGA-II for several. `start` holds numbers of a candidate to begin with.
    """

    minimise: Texts = []
    maximise: Texts = []
    subject_to: Texts = []
    method: Literal["differential evolution", "NSGA-II", "local"] | None = None
    population: Annotated[int, Field(ge=8)] = 100
    generations: Annotated[int, Field(ge=1)] = 100
    seed: Annotated[int, Field(ge=0)] = 0
    start: dict[str, float | str] = {}


def _tolerance(value: object) -> object:
    """A bare quantity as a tolerance of the usual distribution."""
    return value if isinstance(value, dict) else {"plus_minus": value}


class ToleranceText(ScenePart):
    """How far a number of the machine as built may be off: evenly within ±, or normally with ± as three deviations."""

    plus_minus: float | str
    distribution: Literal["uniform", "normal"] = "uniform"


def _kind_of_axis(axis: object) -> str:
    """Which kind of axis the keys mean, misspelt ones apart."""
    keys = set(axis) if isinstance(axis, dict) else set()
    if keys & {"low", "high"}:
        return "between"
    return "listing" if "values" in keys else "range"


def _axis(value: object) -> object:
    """An axis in short, a list or "40 mm to 80 mm, 5", by its keys."""
    if isinstance(value, list):
        return {"values": value}
    if isinstance(value, dict):
        return value
    found = first_last_count(value) if isinstance(value, str) else None
    if found is None:
        example = "'40 mm to 80 mm, 5' (the first, the last, how many), a list, or { low = ..., high = ... } to sample"
        raise ValueError(f"{value!r}: say how it varies, such as {example}; to change it for all variants, derive it")
    return dict(zip(("from", "to", "count"), found, strict=True))


AxisText = Annotated[
    Annotated[Range, Tag("range")] | Annotated[Listing, Tag("listing")] | Annotated[Between, Tag("between")],
    Discriminator(_kind_of_axis),
    BeforeValidator(_axis),
]


class StudyText(ScenePart):
    """A study as it stands in its file.

    `scene` names a scene file beside it, or holds the scene itself. `vary` maps paths of the scene's numbers
    (or free parameters, names without a dot) to axes, in short "40 mm to 80 mm, 5" or a list; `variants` names a CSV
    file whose columns vary together.
    `derive` ties further numbers to those by arithmetic; `require` drops variants that don't meet a condition.
    `optimise` is what `sweeps optimise` searches for, instead of all variants; `tolerances` say how far numbers of
    the machine as built may be off. `accuracy` is the allowed error of every summary, as a share of its magnitude:
    each variant then gets as many positions as that takes, and `positions` is how many the fields have.
    `field_precision` is that in which fields are stored; all is computed in float64.
    """

    title: PlainText = ""
    question: PlainText = ""
    source: PlainText = ""
    scene: str | dict[str, Any]
    positions: int = 720
    accuracy: Annotated[PlainNumber, Field(gt=0, lt=1)] | None = None
    field_precision: Literal["float64", "float32"] = "float64"
    vary: dict[str, AxisText] = {}
    variants: str | None = None
    sampling: Sampling | None = None
    derive: dict[str, str] = {}
    require: list[str] = []
    outputs: Outputs = Outputs()
    best: Best | None = None
    optimise: Optimise | None = None
    tolerances: dict[str, Annotated[ToleranceText, BeforeValidator(_tolerance)]] = {}


TOLERANCE_KEYS = set(ToleranceText.model_fields)
AXIS_KEYS = {"from", "to", "values", "low", "high", "count", "spacing"}
# What others write for these; steps of paths too, but then tables.
MISTAKEN_KEYS = {"start", "stop", "begin", "end", "min", "max", "minimum", "maximum", "steps"}


def flatten(table: object, leaf_keys: set[str] | None, path: tuple[str, ...] = ()) -> dict[str, Any]:
    """Tables by dotted path, whether a path was written quoted or as nested keys.

    Parameters
    ----------
    table : object
        Parsed TOML.
    leaf_keys : set of str or None
        Keys that tell an axis from a step of a path; None where leaves are not tables.
    path : tuple of str
        Path of `table`.
    """
    if not isinstance(table, dict) or (path and leaf_keys and _is_leaf(table, leaf_keys)):
        return {".".join(path): table}
    found: dict[str, Any] = {}
    for key, inner in table.items():
        found |= flatten(inner, leaf_keys, (*path, key))
    return found


def _is_leaf(table: dict[str, Any], leaf_keys: set[str]) -> bool:
    """Whether a table is an axis or tolerance, not a step of a path."""
    mistaken = (key for key, value in table.items() if key in MISTAKEN_KEYS and not isinstance(value, dict))
    return bool(leaf_keys & set(table)) or (leaf_keys is AXIS_KEYS and any(mistaken))


def is_scene(data: Mapping[str, object]) -> bool:
    """Whether the tables of a file are those of a scene, not of a study."""
    return "scene" not in data and bool(data.keys() & (Scene.model_fields.keys() - StudyText.model_fields.keys()))
