"""The keys of a study's text: a scene, what varies in it, and what is asked of it."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from engine.parts import Part


class Range(Part):
    """`count` values from `from` to `to`, ends included; a grid axis."""

    start: Annotated[float | str, Field(alias="from")]
    stop: Annotated[float | str, Field(alias="to")]
    count: Annotated[int, Field(ge=1)]
    spacing: Literal["linear", "log"] = "linear"


class Listing(Part):
    """Explicit values; a grid axis."""

    values: Annotated[list[float | str], Field(min_length=1)]


class Between(Part):
    """Anywhere between two values, drawn by the study's sampling together with all others of its kind."""

    low: float | str
    high: float | str
    spacing: Literal["linear", "log"] = "linear"


class Sampling(Part):
    """How the numbers given by `low` and `high` are drawn."""

    method: Literal["random", "sobol", "latin"] = "sobol"
    count: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)] = 0


class Outputs(Part):
    """What is kept: summaries (numbers per variant) and fields (rows over the crank angle)."""

    summaries: list[str] = []
    fields: list[str] = []


class Best(Part):
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
        return self.minimise or self.maximise

    @property
    def sign(self) -> float:
        """+1 to minimise, −1 to maximise."""
        return 1.0 if self.minimise else -1.0


def _kind_of_axis(axis: object) -> str:
    """Which kind of axis the keys mean, misspelt ones apart."""
    keys = set(axis) if isinstance(axis, dict) else set()
    if keys & {"low", "high"}:
        return "between"
    return "listing" if "values" in keys else "range"


AxisText = Annotated[
    Annotated[Range, Tag("range")] | Annotated[Listing, Tag("listing")] | Annotated[Between, Tag("between")],
    Discriminator(_kind_of_axis),
]


class StudyText(Part):
    """A study as it stands in its file.

    `scene` names a scene file beside it, or holds the scene itself. `vary` maps paths of the scene's numbers
    (or free parameters, names without a dot) to axes; `variants` names a CSV file whose columns vary together.
    `derive` ties further numbers to those by arithmetic; `require` drops variants that don't meet a condition.
    """

    title: str = ""
    question: str = ""
    source: str = ""
    scene: str | dict[str, Any]
    positions: int = 720
    precision: Literal["float64", "float32"] = "float64"
    vary: dict[str, AxisText] = {}
    variants: str | None = None
    sampling: Sampling | None = None
    derive: dict[str, str] = {}
    require: list[str] = []
    outputs: Outputs = Outputs()
    best: Best | None = None


AXIS_KEYS = {"from", "to", "values", "low", "high", "count", "spacing"}


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
    if not isinstance(table, dict) or (path and leaf_keys and leaf_keys & set(table)):
        return {".".join(path): table}
    found: dict[str, Any] = {}
    for key, inner in table.items():
        found |= flatten(inner, leaf_keys, (*path, key))
    return found
