"""The keys of a study."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from engine import PlainNumber, PlainText, Scene, ScenePart, UnitSystem, first_last_count
from sweeps.text.conditions import all_of


def _listed(value: object) -> object:
    """A single text as a list of one."""
    return [value] if isinstance(value, str) else value


Texts = Annotated[list[str], BeforeValidator(_listed, json_schema_input_type=list[str] | str)]


def _no_boolean(value: object) -> object:
    if isinstance(value, bool):
        raise ValueError(f"expected a number or a text such as '40 mm', got {str(value).lower()}")
    return value


_Given = Annotated[float | str, BeforeValidator(_no_boolean, json_schema_input_type=float | str)]


class Range(ScenePart):
    """`count` values from `from` to `to`, inclusive; a grid axis."""

    start: Annotated[_Given, Field(alias="from")]
    stop: Annotated[_Given, Field(alias="to")]
    count: Annotated[int, Field(ge=1)]
    spacing: Literal["linear", "log"] = "linear"


class Listing(ScenePart):
    """Explicit values; a grid axis."""

    values: Annotated[list[_Given], Field(min_length=1)]


class Between(ScenePart):
    """A range sampled by the study's `sampling`, together with all other ranges."""

    low: _Given
    high: _Given
    spacing: Literal["linear", "log"] = "linear"


class SizeSeries(ScenePart):
    """Standard sizes from `low` to `high`; sampled like a range where the study samples, else a grid axis."""

    choose: Literal["R5", "R10", "R20", "R40", "IEC"]
    low: _Given
    high: _Given


class SizeList(ScenePart):
    """Sizes of available parts; sampled like a range where the study samples, else a grid axis."""

    choose: Annotated[list[_Given], Field(min_length=1)]


Sizes = SizeSeries | SizeList


class Sampling(ScenePart):
    """Sampling of the numbers given by `low` and `high`, or by `choose`."""

    method: Literal["random", "sobol", "latin"] = "sobol"
    count: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0, lt=2**64)] = 0


class Outputs(ScenePart):
    """Outputs: summaries (numbers per variant), fields (curves over the crank angle), derivatives of summaries.

    A derivative is written "excess_work by input.length".
    """

    summaries: Texts = []
    fields: Texts = []
    derivatives: Texts = []


class Best(ScenePart):
    """The best variant: minimum or maximum of a parameter or result among the variants that meet `where`."""

    minimise: str | None = None
    maximise: str | None = None
    where: Texts = []

    @model_validator(mode="after")
    def _one_goal(self) -> "Best":
        if (self.minimise is None) == (self.maximise is None):
            raise ValueError("give either minimise or maximise, the name of a parameter or result")
        return self

    @property
    def goal(self) -> str:
        """Name of the objective."""
        return self.maximise if self.minimise is None else self.minimise

    @property
    def sign(self) -> float:
        """+1 to minimise, −1 to maximise."""
        return -1.0 if self.minimise is None else 1.0

    @property
    def word(self) -> str:
        """Whether the minimum or the maximum is sought."""
        return "maximum" if self.minimise is None else "minimum"

    @property
    def key(self) -> str:
        """The key of the objective."""
        return "maximise" if self.minimise is None else "minimise"

    @property
    def condition(self) -> str:
        """All conditions as one text, "" if there are none."""
        return all_of(self.where)


class Optimise(ScenePart):
    """Search task: expressions of parameters and results, conditions `where`, and method.

    Default goal: the study's `best`. Default `method`: differential evolution for one objective, NSGA-II for several.
    `start` holds the numbers of the first candidate.
    """

    minimise: Texts = []
    maximise: Texts = []
    where: Texts = []
    method: Literal["differential evolution", "NSGA-II", "local"] | None = None
    population: Annotated[int, Field(ge=8)] = 100
    generations: Annotated[int, Field(ge=1)] = 100
    seed: Annotated[int, Field(ge=0, lt=2**64)] = 0
    start: dict[str, _Given] = {}


def _tolerance(value: object) -> object:
    """A bare quantity as a tolerance of the usual distribution."""
    return value if isinstance(value, dict) else {"plus_minus": value}


class ToleranceText(ScenePart):
    """Tolerance of a number: uniform within ±, or normal with ± as three standard deviations."""

    plus_minus: _Given
    distribution: Literal["uniform", "normal"] = "uniform"


def _kind_of_axis(axis: object) -> str:
    """Kind of axis by its keys, tolerating misspelt ones."""
    keys = set(axis) if isinstance(axis, dict) else set()
    if "choose" in keys:
        return "size list" if isinstance(axis["choose"], list) else "size series"
    if keys & {"low", "high"}:
        return "between"
    return "listing" if "values" in keys else "range"


def _axis(value: object) -> object:
    """Expand a short axis, a list or "40 mm to 80 mm, 5"."""
    if isinstance(value, list):
        return {"values": value}
    if isinstance(value, dict):
        return value
    found = first_last_count(value) if isinstance(value, str) else None
    if found is None:
        example = "'40 mm to 80 mm, 5' (the first, the last, how many), a list, or { low = ..., high = ... } to sample"
        raise ValueError(f"{value!r}: give its variation, such as {example}; to change it for all variants, derive it")
    return dict(zip(("from", "to", "count"), found, strict=True))


_Axis = Annotated[
    Annotated[Range, Tag("range")]
    | Annotated[Listing, Tag("listing")]
    | Annotated[Between, Tag("between")]
    | Annotated[SizeSeries, Tag("size series")]
    | Annotated[SizeList, Tag("size list")],
    Discriminator(_kind_of_axis),
]
AxisText = Annotated[_Axis, BeforeValidator(_axis, json_schema_input_type=_Axis | list[float | str] | str)]


class StudyText(ScenePart):
    """A study file.

    `scene` names a scene file in the same folder, or is the scene itself. `vary` maps paths of the scene's numbers (or
    free parameters, names without a dot) to axes, in short "40 mm to 80 mm, 5" or a list; `variants` names a CSV file
    whose columns vary together.
    `derive` computes further numbers from those. `require` drops variants before they are computed, by conditions on
    parameters; conditions with results belong to `where` of `best`, `optimise`, `sweeps show`, `plot` and `export`.
    `optimise` is the task of `sweeps optimise`; `tolerances` are manufacturing tolerances of numbers. `accuracy` is the
    relative tolerance of every summary, which sets the positions per variant; `positions` is the number of field
    positions. `units` replaces the scene's.
    `field_precision` is the storage precision of fields; everything is computed in float64.
    """

    hints: ClassVar[dict[str, str]] = {
        "scene": 'name the file of the scene, scene = "press.toml"',
        "where": "where belongs to [best] or [optimise]; require, above the first table, drops variants before they "
        "are computed",
        "require": "require stands above the first table: it drops variants before they are computed",
        "vary.count": "add it; a range that [sampling] samples has low and high in place of from and to",
        "count": "count belongs to from and to, or to [sampling] for all ranges of low and high",
    }
    title: PlainText = ""
    question: PlainText = ""
    source: PlainText = ""
    units: UnitSystem | None = None
    scene: str | dict[str, Any]
    positions: int = 720
    accuracy: Annotated[PlainNumber, Field(gt=0, lt=1)] | None = None
    field_precision: Literal["float64", "float32"] = "float64"
    vary: dict[str, AxisText] = {}
    variants: str | None = None
    sampling: Sampling | None = None
    derive: dict[str, str] = {}
    require: Texts = []
    outputs: Outputs = Outputs()
    best: Best | None = None
    optimise: Optimise | None = None
    tolerances: dict[
        str, Annotated[ToleranceText, BeforeValidator(_tolerance, json_schema_input_type=ToleranceText | float | str)]
    ] = {}


TOLERANCE_KEYS = set(ToleranceText.model_fields)
AXIS_KEYS = {"from", "to", "values", "low", "high", "count", "spacing", "choose"}
# Common misspellings; as steps of paths they are tables.
MISTAKEN_KEYS = {"start", "stop", "begin", "end", "min", "max", "minimum", "maximum", "steps"}


def flatten(table: object, leaf_keys: set[str] | None, path: tuple[str, ...] = ()) -> dict[str, Any]:
    """Tables by dotted path, for quoted paths and nested keys.

    Parameters
    ----------
    table : object
        Parsed TOML.
    leaf_keys : set of str or None
        Keys that distinguish an axis from a path step; None if leaves are not tables.
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
    """Whether a table is an axis or tolerance, not a path step."""
    mistaken = (key for key, value in table.items() if key in MISTAKEN_KEYS and not isinstance(value, dict))
    return bool(leaf_keys & set(table)) or (leaf_keys is AXIS_KEYS and any(mistaken))


def is_scene(data: Mapping[str, object]) -> bool:
    """Whether a file is a scene, not a study."""
    return "scene" not in data and bool(data.keys() & (Scene.model_fields.keys() - StudyText.model_fields.keys()))
