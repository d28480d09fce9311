"""The skeleton of a scene: points, guides, the input, structural groups, free links; and the base of all parts.

Conventions
-----------
A point, a guide and a body belong to a link; the frame is the link called "frame". Coordinates on a link refer to the
link's axes: the origin and x axis of

- a crank or shaft: its pivot, towards the pin (a shaft: along its angle);
- a link of RRR and the rod of RRP: its outer joint, towards the inner joint;
- a slider: its joint (for a block of RPR or RPP, the outer joint), along its guide or slot;
- the rocker of RPR: its pivot, along the slot;
- the sliding link of RPP: the intersection of slot and guide, along the guide;
- a free link: its first joint, towards the second; on a guide, along the guide; see `FreeLink`.

Plain numbers are SI; text takes units ("80 mm").
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    StringConstraints,
    ValidationInfo,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError

from engine.units.dimensions import described
from engine.units.display import quantity_text
from engine.units.reading import in_text, to_si
from engine.words.glossary import enumerated

FRAME = "frame"

# What is wrong with a part, in words; only the first fault counts.
Faults = Iterator[str]

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*$")]


class Refers(NamedTuple):
    """Marks a name that refers to something of a kind in the scene, as `engine.scene.names` lists them."""

    kind: str


PointRef, GuideRef = Annotated[Name, Refers("point")], Annotated[Name, Refers("guide")]
LinkRef, ActionRef = Annotated[Name, Refers("link")], Annotated[Name, Refers("action")]
FramePoint = Annotated[PointRef, Refers("point of the frame")]
FrameGuide = Annotated[GuideRef, Refers("guide of the frame")]
AxesRef = Annotated[LinkRef, Refers("link with axes")]
SliderRef, GearedRef = Annotated[LinkRef, Refers("slider")], Annotated[LinkRef, Refers("geared shaft")]


def _printable(text: str) -> str:
    """Reject control characters, which terminals and files could take as commands."""
    for character in text:
        if not character.isprintable() and character not in "\n\t":
            raise ValueError(f"contains the control character {character!r}; write plain text")
    return text


PlainText = Annotated[str, AfterValidator(_printable)]


class NonZero(AfterValidator):
    """Marks a number that must not be 0, in a scene and in every variant; `why` is the message."""

    ne = 0.0

    def __init__(self, why: str) -> None:
        def checked(value: float) -> float:
            if value == self.ne:
                raise PydanticCustomError("non_zero", why)
            return value

        super().__init__(checked)


class DimensionMark(str):
    """Marks a number of a scene with its dimension, a key of `engine.units.dimensions.DIMENSIONS`."""

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(schema), "type": ["number", "string"], "dimension": str(self)}


def quantity(dimension: str) -> type:
    """Type of a number of the given dimension: SI as a number, any known unit as text."""

    def read(value: object, info: ValidationInfo) -> float:
        from_text = bool(info.context and info.context.get("text"))
        return in_text(value, dimension) if from_text else to_si(value, dimension)

    return Annotated[float, BeforeValidator(read), DimensionMark(dimension)]


Length = quantity("length")
Positive = Annotated[Length, Field(gt=0)]
Angle = quantity("angle")
Mass = quantity("mass")
Inertia = quantity("inertia")
Density = quantity("density")
Area = quantity("area")
Speed = quantity("speed")
AngularSpeed = quantity("angular_speed")
Acceleration = quantity("acceleration")
Number = quantity("number")
Time = quantity("time")
Pressure = quantity("pressure")
Moment = quantity("moment")
Power = quantity("power")
Mode = Literal[1, -1]


class SceneNumber(NamedTuple):
    """A number of a scene: its value (SI), its dimension, its limits or choices, and the path of a lower number."""

    value: float
    dimension: str
    limits: tuple[Gt | Ge | Lt | Le | NonZero, ...]
    choices: tuple[float, ...] = ()
    above: str = ""


class Part(BaseModel):
    """Base of everything in a scene: unknown keys are rejected, and values are immutable.

    Attributes
    ----------
    one_of, at_most_one_of, together : tuple of tuple of str
        Optional keys of which a class requires exactly one, of which it allows one, and which it takes all or none.
    ascending : dict of tuple of str to str
        Keys whose values must ascend, with the reason.
    needs : dict of str to tuple of str
        Keys that have a meaning only with one of the others.
    goes_with, required_with : dict of str to tuple
        Keys allowed only if another key has one of some values, and keys that are then required: (other key, values).

    These rules hold in addition to those of the bases. A class that has more to check, or that computes what can fail
    with a `ValueError`, defines `_faults`.
    """

    one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_most_one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    together: ClassVar[tuple[tuple[str, ...], ...]] = ()
    ascending: ClassVar[dict[tuple[str, ...], str]] = {}
    needs: ClassVar[dict[str, tuple[str, ...]]] = {}
    goes_with: ClassVar[dict[str, tuple[str, tuple[str, ...]]]] = {}
    required_with: ClassVar[dict[str, tuple[str, tuple[str, ...]]]] = {}
    # A model is built with the first model that holds it, not by itself.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    @model_validator(mode="after")
    def _is_sound(self) -> "Part":
        kinds = type(self).__mro__
        for kind in kinds:
            for fault in self._broken(vars(kind)):
                raise ValueError(fault)
        for kind in reversed(kinds):
            for fault in vars(kind)["_faults"](self) or () if "_faults" in vars(kind) else ():
                raise ValueError(fault)
        return self

    def _broken(self, rules: Mapping[str, Any]) -> Faults:
        """The rules of a class that the part breaks, in words."""
        for keys in rules.get("one_of", ()):
            if len(self.gives(*keys)) != 1:
                yield f"give {' or '.join(keys)}, one of the {'two' if len(keys) == 2 else 'three'}"
        for keys in rules.get("at_most_one_of", ()):
            if len(given := self.gives(*keys)) > 1:
                yield f"{' and '.join(given)} are given; give one of {', '.join(keys)}, or none"
        for keys in rules.get("together", ()):
            if 0 < len(self.gives(*keys)) < len(keys):
                ways = "both, or neither" if len(keys) == 2 else "all, or none"
                yield f"{enumerated(keys)} belong together: give {ways}"
        for keys, why in rules.get("ascending", {}).items():
            for low, high in self._ascending(keys):
                if not getattr(self, low) < getattr(self, high):
                    yield f"{self._in_words(high)} is not above {self._in_words(low)}: {why}"
        for key, others in rules.get("needs", {}).items():
            if self.gives(key) and all(getattr(self, o) is None for o in self.model_fields_set.intersection(others)):
                missing = " or ".join(others)
                yield f"{key} has no meaning without {missing}: give {missing}, or leave {key} out"
        for rule in ("goes_with", "required_with"):
            for key, (other, values) in rules.get(rule, {}).items():
                value, given = getattr(self, other), bool(self.gives(key))
                if given and value not in values:
                    yield f"{key} goes with {other} = {' or '.join(map(repr, values))}; the {other} is {value!r}"
                if rule == "required_with" and not given and value in values:
                    yield f"{key} is missing: {other} = {value!r} needs it; add it"

    def _ascending(self, keys: Iterable[str]) -> Iterator[tuple[str, str]]:
        """Neighbours among the keys that are given."""
        return pairwise(key for key in keys if getattr(self, key) is not None)

    def _in_words(self, key: str) -> str:
        """A number with its key and unit."""
        unit = described(field_dimension(type(self).model_fields[key])).unit
        return f"{key} = {quantity_text(getattr(self, key), unit)}"

    def numbers_within(self, path: str = "") -> Iterator[tuple[str, SceneNumber]]:
        """Every number of this part and its subparts that a study may vary, by path.

        Excluded are entries of tables, counts (revolutions, arms) and numbers that aren't given.

        Parameters
        ----------
        path : str
            Path of this part.
        """
        orders = [keys for kind in type(self).__mro__ for keys in vars(kind).get("ascending", ())]
        lower = {high: low for keys in orders for low, high in self._ascending(keys)}
        for key, field in type(self).model_fields.items():
            value, within = getattr(self, key), f"{path}." if path else ""
            here, above = within + key, within + lower[key] if key in lower else ""
            if isinstance(value, Part):
                yield from value.numbers_within(here)
            elif isinstance(value, dict):
                for name, inner in value.items():
                    yield from inner.numbers_within(f"{here}.{name}")
            elif isinstance(value, (int, float)) and not isinstance(value, bool):
                dimension, limits = _marked(type(self), key)
                if dimension is not None:
                    yield here, SceneNumber(float(value), dimension, limits, above=above)
                elif field.annotation == Mode:
                    yield here, SceneNumber(float(value), "number", (), get_args(Mode))

    def references(self, path: str = "") -> Iterator[tuple[str, str, str]]:
        """Every name that this part and its subparts refer to: path, kind of the target, name.

        Parameters
        ----------
        path : str
            Path of this part.
        """
        for key in type(self).model_fields:
            value, here = getattr(self, key), f"{path}.{key}" if path else key
            if isinstance(value, Part):
                yield from value.references(here)
            elif isinstance(value, dict):
                for name, inner in value.items():
                    yield from ((f"{here}.{name}", kind, name) for kind in _referred(type(self), key))
                    yield from inner.references(f"{here}.{name}")
            elif value is not None:
                names = [value] if isinstance(value, str) else value
                yield from ((here, kind, name) for kind in _referred(type(self), key) for name in names)

    def gives(self, *keys: str) -> list[str]:
        """Which of the keys differ from their defaults.

        Keys that have no effect are rejected: if ignored, they would seem to have one.

        Parameters
        ----------
        *keys : str
        """
        return [key for key in keys if getattr(self, key) != type(self).model_fields[key].default]

    def own_numbers(self) -> dict[str, np.ndarray]:
        """The part's numbers by their paths in it, as one variant."""
        return {path: np.array([number.value]) for path, number in self.numbers_within()}


def field_marks(field: FieldInfo) -> list:
    """All marks of a field, including those of entries and inside optionals."""
    return _marks(field.annotation, field.metadata)


def field_dimension(field: FieldInfo) -> str | None:
    """Dimension of the numbers in a field; None if it has none."""
    return next((str(mark) for mark in field_marks(field) if isinstance(mark, DimensionMark)), None)


def _marks(annotation: object, metadata: Iterable) -> list:
    found = []
    for mark in metadata:
        found += mark.metadata if isinstance(mark, FieldInfo) else [mark]
    for inner in get_args(annotation):
        found += _marks(inner, getattr(inner, "__metadata__", ()))
    return found


@cache
def _marked(kind: type[Part], key: str) -> tuple[str | None, tuple]:
    """Dimension and limits of a number in a kind of part."""
    field = kind.model_fields[key]
    return field_dimension(field), tuple(m for m in field_marks(field) if isinstance(m, (Gt, Ge, Lt, Le, NonZero)))


@cache
def _referred(kind: type[Part], key: str) -> tuple[str, ...]:
    """Kinds that the target of a field must be of; for a table, of its keys."""
    field = kind.model_fields[key]
    if get_origin(field.annotation) is dict:
        marks = _marks(tuple[get_args(field.annotation)[0]], [])
    else:
        marks = field_marks(field)
    return tuple(dict.fromkeys(mark.kind for mark in marks if isinstance(mark, Refers)))


class Point(Part):
    """A point of a link (by default of the frame), in the link's axes."""

    link: AxesRef = FRAME
    x: Length
    y: Length


class Guide(Part):
    """A straight guide on a link (by default the frame), through a point, at an angle to the link's x axis."""

    link: AxesRef = FRAME
    x: Length = 0.0
    y: Length = 0.0
    angle: Angle = 0.0


_RUNS = NonZero("the input is at rest: give its mean speed, such as '60 rpm' (negative: reversed)")
# Maximum number of crank turns in a cycle; longer cycles would be sampled too coarsely.
MOST_REVOLUTIONS = 24


class CrankInput(Part):
    """Rotating input link: a crank from a `pivot` on the frame to a `pin`; the generalised coordinate is its angle.

    A wheel or drum with no link hinged to it needs no `pin` or `length`.
    `start` and `stop` limit a crank that doesn't turn fully; without them a cycle is `revolutions` turns.
    """

    together: ClassVar = (("pin", "length"), ("start", "stop"))
    ascending: ClassVar = {("start", "stop"): "the crank turns from one to the other"}

    type: Literal["crank"]
    link: Name = "crank"
    pivot: FramePoint
    pin: Name | None = None
    length: Annotated[Length, Field(gt=0)] | None = None
    speed: Annotated[AngularSpeed, _RUNS]
    revolutions: Annotated[int, Field(ge=1, le=MOST_REVOLUTIONS)] = 1
    start: Angle | None = None
    stop: Angle | None = None

    @property
    def turns_fully(self) -> bool:
        """Whether the machine has a closed cycle."""
        return self.start is None

    def _faults(self) -> Faults:
        if self.start is not None and self.gives("revolutions"):
            yield "revolutions belong to a cycle, and a crank limited by start and stop has none; omit them"


class SliderInput(Part):
    """Sliding input link on a guide of the frame; the generalised coordinate is its displacement along the guide.

    `start` and `stop` are the ends of its travel. `speed` is its mean speed, positive in the direction of the guide.
    `point` names its point on the guide, at which other links can be hinged.
    """

    turns_fully: ClassVar[bool] = False

    type: Literal["slider"]
    link: Name
    guide: FrameGuide
    point: Name
    start: Length
    stop: Length
    speed: Annotated[Speed, _RUNS]

    def _faults(self) -> Faults:
        if self.start == self.stop:
            yield "start and stop are the same: give the two ends of its travel"


class Hinged(Part):
    """A link of a group between its outer joint (a known point) and the inner joint, at the distance `length`."""

    link: Name
    joint: PointRef
    length: Annotated[Length, Field(gt=0)]


class Sliding(Part):
    """A slider of a group on a known guide; `offset` is the distance of its joint to the left of the guide."""

    link: Name
    guide: GuideRef
    offset: Length = 0.0


class Block(Part):
    """A sliding block of a group, pivoted at a known point."""

    link: Name
    joint: PointRef


class Rocker(Part):
    """The slotted link of RPR, pivoted at a known point; `offset` is the distance of the block's pivot to its left."""

    link: Name
    joint: PointRef
    offset: Length = 0.0


class Yoke(Part):
    """The slotted link of RPP on a known guide; `slot_angle` is the angle of its slot to the guide."""

    link: Name
    guide: GuideRef
    slot_angle: Angle


class RRR(Part):
    """Dyad of two bars; `mode` +1: the inner joint lies to the left of the line first joint → second joint."""

    type: Literal["RRR"]
    inner: Name
    first: Hinged
    second: Hinged
    mode: Mode = 1


class RRP(Part):
    """Dyad of a rod and a slider; `mode` +1: of the two possible slider positions, the one farther along the guide."""

    type: Literal["RRP"]
    inner: Name
    first: Hinged
    second: Sliding
    mode: Mode = 1


class RPR(Part):
    """Dyad of a pivoted block and a slotted rocker; `mode` +1: the rocker points from its pivot to the block."""

    type: Literal["RPR"]
    first: Block
    second: Rocker
    mode: Mode = 1


class PRP(Part):
    """Dyad of two sliders on two guides, hinged together; it has a single assembly mode."""

    type: Literal["PRP"]
    inner: Name
    first: Sliding
    second: Sliding


class RPP(Part):
    """Dyad of a pivoted block in the slot of a link that slides on a guide (Scotch yoke); a single assembly mode."""

    type: Literal["RPP"]
    first: Block
    second: Yoke


Group = Annotated[RRR | RRP | RPR | PRP | RPP, Field(discriminator="type")]


class FreeLink(Part):
    """A link whose group the program finds: `joints` connect it to other links, or a `guide` on which it slides.

    Naming a point of another link here makes it a joint. With two joints, `length` apart, the link's origin is the
    first and its x axis points to the second; with one joint, the origin is that joint. On a `guide` its x axis is
    parallel to the guide. `offset` is the distance of the origin to the left of the guide. A link connected only by
    other links that name its points needs no joints; its axes are then arbitrary.
    """

    needs: ClassVar = {"offset": ("guide",)}

    joints: tuple[Name, ...] = ()
    length: Annotated[Length, Field(gt=0)] | None = None
    guide: GuideRef | None = None
    offset: Length = 0.0

    def _faults(self) -> Faults:
        allowed = 2 if self.guide is None else 1
        if len(self.joints) > allowed:
            on_guide = "" if self.guide is None else " on a guide"
            yield (
                f"joints names {len(self.joints)} points; a link{on_guide} takes up to {allowed}: make the others "
                'points of this link, [points] NAME = { link = "…", x = …, y = … }, and name them at the other links'
            )
        if len(set(self.joints)) < len(self.joints):
            yield f"joints names {self.joints[0]!r} twice; name two points"
        if (len(self.joints) == 2) != (self.length is not None):
            yield "length is the distance of two joints: give both, or neither"


class Near(Part):
    """Approximate position of a point of a free link at the input's first position; it selects the assembly mode."""

    x: Length
    y: Length
