"""A scene: the description of one machine, and its numbers by path."""

import operator
from collections.abc import Callable, Iterator, Mapping
from functools import wraps
from typing import Annotated, Any, ClassVar, TypeVar
from weakref import finalize

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import Field, ValidationError, model_validator

from engine import scene
from engine.elements.element import MachineElement
from engine.parts.actions import ForceAction, MomentAction, Spring
from engine.parts.bodies import AcceleratedBase, Balance, Body, Flywheel
from engine.parts.couplings import Coupling
from engine.parts.cylinders import CylinderAction
from engine.parts.higher_pairs import DrivingCam, NoncircularWheel, Pinion, Rack, Shaft
from engine.parts.pair_friction import PairFriction
from engine.parts.regimes import Regime
from engine.parts.requirements import Pin, Strut, WantedMotion, WarningLimits
from engine.parts.second_inputs import SecondInput
from engine.parts.skeleton import (
    Acceleration,
    CrankInput,
    FreeLink,
    Group,
    Guide,
    Name,
    Near,
    NonZero,
    Part,
    PlainText,
    Point,
    PointRef,
    SceneNumber,
    SliderInput,
)
from engine.units.dimensions import described
from engine.units.display import UnitSystem, quantity_text
from engine.words.user_error import UserError

# Path and message, for the user.
Problem = tuple[str, str]


class SceneError(UserError, ValueError):
    """A rejected scene."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(f"{path}: {message}" if path else message for path, message in problems))


class _RefusedInWords(type(Part)):
    """Reports wrong input of `Scene(...)` in plain words."""

    def __call__(cls, *args: Any, **data: Any) -> Any:
        try:
            return super().__call__(*args, **data)
        except ValidationError as error:
            raise SceneError(scene.wrong_input.wrong_input(cls, data, error)) from None


# Tables allowed in a scene of machine elements without a mechanism.
_ALONE = {"title", "source", "units", "limits", "elements"}


_SINGULAR = {"bodies": "body"}


class Scene(Part, metaclass=_RefusedInWords):
    """One machine: geometry, input, structural groups, bodies, and loads.

    Groups may be listed in any order; free `links` form groups of any class, whose assembly mode `near` selects.
    `gravity` acts along −y. The `base` may be accelerated. Without `inertia_in_reactions`, for slow machines, reactions
    include the applied loads only; all other results keep the inertia. `source` cites the origin of the numbers.
    Results are shown in `units`, whatever units the scene uses. The motion is compared with what is `wanted`. Beyond
    its `limits` the program warns. A scene of machine elements only has no input.
    """

    hints: ClassVar[dict[str, str]] = {
        "input": 'add a table [input] of type "crank" or "slider"; see `sweeps help input`'
    }
    title: PlainText = ""
    source: PlainText = ""
    units: UnitSystem = "mm"
    gravity: Acceleration = 0.0
    base: AcceleratedBase | None = None
    points: dict[Name, Point] = {}
    guides: dict[Name, Guide] = {}
    input: Annotated[CrankInput | SliderInput, Field(discriminator="type")] | None
    inputs: dict[Name, SecondInput] = {}
    groups: dict[Name, Group] = {}
    links: dict[Name, FreeLink] = {}
    near: dict[PointRef, Near] = {}
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
    pins: dict[Name, Pin] = {}
    struts: dict[Name, Strut] = {}
    inertia_in_reactions: bool = True
    balance: Balance | None = None
    regimes: dict[Name, Regime] = {}
    limits: WarningLimits | None = None
    wanted: dict[Name, WantedMotion] = {}
    elements: dict[Name, MachineElement] = {}

    @property
    def has_cycle(self) -> bool:
        """Whether the input turns fully, so that the machine has a closed cycle."""
        return self.input is not None and self.input.turns_fully

    def __repr__(self) -> str:
        title = f" {self.title!r}" if self.title else ""
        drive = [f"input {self.input.link}"] if self.input else []
        groups = [f"{group.type} {name}" for name, group in self.groups.items()]
        others = ("links", "bodies", "forces", "moments", "springs", "cylinders", "regimes", "elements")
        held = {key: len(getattr(self, key)) for key in others}
        counted = [f"{n} {key if n > 1 else _SINGULAR.get(key, key[:-1])}" for key, n in held.items() if n]
        return f"<Scene{title}: {', '.join([*drive, *groups, *counted])}>"

    __str__ = __repr__

    @classmethod
    def model_validate(cls, obj: Any, **options: Any) -> "Scene":
        """A scene of nested tables, whose quantities may be texts with units.

        Parameters
        ----------
        obj : dict
        **options
            As for any model of pydantic.

        Raises
        ------
        SceneError
            All problems, each with its key.
        """
        try:
            return super().model_validate(obj, **options)
        except ValidationError as error:
            raise SceneError(scene.wrong_input.wrong_input(cls, obj, error)) from None

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
            raise ValueError("input is missing: add it; only a scene of machine elements alone has none")
        if not self.has_cycle:
            for name, element in self.elements.items():
                key, why = element.machine_needed()
                if why:
                    raise ValueError(f"elements.{name}{key}: {why}")
        return self


Found = TypeVar("Found")


def once(function: Callable[[Scene], Found]) -> Callable[[Scene], Found]:
    """Cache a function's result for the lifetime of the scene, which is immutable."""
    found: dict[int, Found] = {}

    @wraps(function)
    def kept(scene: Scene) -> Found:
        key = id(scene)
        if key not in found:
            found[key] = function(scene)
            finalize(scene, found.pop, key, None)
        return found[key]

    return kept


@once
def scene_numbers(scene: Scene) -> dict[str, SceneNumber]:
    """Every number of a scene that a study may vary, by its path, such as "groups.rod.first.length".

    Excluded are entries of tables, counts (revolutions, arms) and numbers that the scene doesn't give.
    """
    return dict(scene.numbers_within())


# Kinds of limits: the attribute with the bound, the sign, and the comparison of a value with it.
_LIMITS = {
    Gt: ("gt", ">", operator.gt),
    Ge: ("ge", "≥", operator.ge),
    Lt: ("lt", "<", operator.lt),
    Le: ("le", "≤", operator.le),
    NonZero: ("ne", "≠", operator.ne),
}


def within_limits(number: SceneNumber, values: np.ndarray) -> np.ndarray:
    """Which values are finite and within the number's limits; an assembly mode must be +1 or −1.

    Parameters
    ----------
    number : SceneNumber
    values : ndarray
        Values in SI units, any shape.
    """
    keep = np.isin(values, number.choices) if number.choices else np.isfinite(values)
    for limit in number.limits:
        key, _, compares = _LIMITS[type(limit)]
        keep &= compares(values, getattr(limit, key))
    return keep


def allowed_text(number: SceneNumber) -> str:
    """The limits or choices of a number, such as "> 0" or "1 or -1"; "finite" if it has none."""
    unit, bounds = described(number.dimension).unit, []
    for limit in number.limits:
        key, sign, _ = _LIMITS[type(limit)]
        bound = getattr(limit, key)
        bounds.append(f"{sign} {quantity_text(bound, unit) if bound else 0}")
    bounds += [f"> {number.above}"] if number.above else []
    return " or ".join(f"{choice:g}" for choice in number.choices) or " and ".join(bounds) or "finite"


class Numbers(Mapping[str, float | np.ndarray]):
    """The numbers of a scene for a set of variants: varied numbers as arrays, all others as floats.

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
        # A NumPy float: overflow and division by zero give inf or NaN, as in an array.
        return np.float64(self._fixed[path].value)

    def of_each(self, path: str, count: int) -> np.ndarray:
        """A number of each of `count` variants, also if it isn't varied."""
        return np.broadcast_to(self[path], (count,)).astype(float)

    def with_values(self, values: Mapping[str, np.ndarray]) -> "Numbers":
        """Copy with some of the numbers replaced."""
        return Numbers(self._fixed, {**self._varied, **values})

    def interpolated(self, share: float | np.ndarray) -> "Numbers":
        """Numbers interpolated from the scene's (share 0) to these (share 1); discrete choices are taken from these.

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
            Index of the variants.
        """
        return Numbers(self._fixed, {path: values[chosen] for path, values in self._varied.items()})

    def below(self, path: str) -> dict[str, float | np.ndarray]:
        """The numbers of the part at `path`, by their keys in the part, including varied keys it does not give."""
        start = f"{path}."
        paths = dict.fromkeys((*self._fixed, *self._varied))
        return {known.removeprefix(start): self[known] for known in paths if known.startswith(start)}

    def __iter__(self) -> Iterator[str]:
        return iter(self._fixed)

    def __len__(self) -> int:
        return len(self._fixed)
