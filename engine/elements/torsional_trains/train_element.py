"""A torsional train as a machine element of a scene: its masses, shafts and gears, and the moments that excite it."""

from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.elements.engines.engine_element import EngineElement
from engine.elements.torsional_trains.train_layout import FRAME_END, Joint, LayoutProblem, TrainLayout, train_layout
from engine.parts.actions import Moment, TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Angle, AngularSpeed, Inertia, Name, Number, Part

MOST_MASSES = 1000


class TrainMass(Part):
    """A rigid disc, wheel, rotor or throw; `damping` against the frame."""

    inertia: Annotated[Inertia, Field(gt=0)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] = 0.0


class TrainShaft(Part):
    """A shaft between two masses, or a mass and the `frame`; its stiffness given, or that of its parts in series.

    Stiffness and damping are about the axis of the first end. `ratio` is the speed of the second end over that of the
    first, where teeth or belts that give way are among the parts. `energy_absorption` is the share of the greatest
    energy dissipated in a cycle.
    """

    between: tuple[Name, Name]
    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    energy_absorption: Annotated[Number, Field(ge=0)] | None = None
    ratio: Number = 1.0

    @model_validator(mode="after")
    def _stiffness_in_one_way(self) -> "TrainShaft":
        if (self.stiffness is None) == (self.parts is None):
            raise ValueError("give stiffness or parts, one of the two")
        if self.parts is not None and (self.damping is not None or self.energy_absorption is not None):
            raise ValueError("the parts have their own dampers: give damping or energy_absorption to them")
        if self.ratio == 0:
            raise ValueError("ratio = 0: the ends would not turn together; give speed of the second over the first")
        return self


class TrainGear(Part):
    """Gears that don't give way; `ratio` is the speed of the second mass over that of the first, negative outside."""

    between: tuple[Name, Name]
    ratio: Number

    @model_validator(mode="after")
    def _turns(self) -> "TrainGear":
        if self.ratio == 0:
            raise ValueError("ratio = 0: give the speed of the second mass over that of the first")
        return self


class HarmonicMoment(Part):
    """A moment on a mass, amplitude · cos(order · Ω t + phase), with Ω the `speed`; of order 0 a mean one."""

    on: Name
    order: Annotated[float, Field(ge=0, le=1000)]
    amplitude: Moment
    phase: Angle = 0.0


class TorsionalTrain(Part):
    """Masses joined by shafts and gears, in a chain or branched.

    The first `modes` natural frequencies above zero and their modes are computed, and the vibration under
    `excitations` at a `speed`, whose multiples are their orders. An `engine` excites the masses `cylinders_at`, one for
    each cylinder in the order of their numbers, with gas and inertia at its own speed, which is then the train's.
    `machine_at` is the mass on which the scene's own machine acts with the harmonics of M − ½ ω² dI/dφ at its crank's
    uniform speed, which is then the train's; without an inertia of its own that mass has the mean of the machine's
    reduced moment of inertia over the crank angle, and its flywheel.
    At the mass `load` something takes what mean moments leave over; without it that accelerates the whole train.
    """

    type: Literal["torsional_train"]
    masses: Annotated[dict[Name, TrainMass], Field(min_length=1, max_length=MOST_MASSES)]
    shafts: dict[Name, TrainShaft] = {}
    gears: dict[Name, TrainGear] = {}
    modes: Annotated[int, Field(ge=1, le=50)] = 3
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    excitations: dict[Name, HarmonicMoment] = {}
    engine: EngineElement | None = None
    cylinders_at: tuple[Name, ...] = ()
    machine_at: Name | None = None
    load: Name | None = None

    @model_validator(mode="after")
    def _hangs_together(self) -> "TorsionalTrain":
        if FRAME_END in self.masses:
            raise ValueError(f"masses.{FRAME_END}: this name is that of the frame; choose another")
        names = [*self.masses, *self.shafts, *self.gears]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"{twice[0]} stands for two things; masses, shafts and gears need names of their own")
        try:
            layout = self.layout
        except LayoutProblem as problem:
            raise ValueError(str(problem)) from None
        if not layout.shaft_to[1:] and not layout.grounded:
            raise ValueError("shafts is missing: masses without a shaft between them don't vibrate")
        self._check_excitations()
        return self

    @model_validator(mode="after")
    def _masses_have_inertia(self) -> "TorsionalTrain":
        for name, mass in self.masses.items():
            if mass.inertia is None and name != self.machine_at:
                raise ValueError(
                    f"masses.{name}.inertia is missing; only the mass that is machine_at takes the machine's own"
                )
        return self

    @property
    def takes_machine_inertia(self) -> bool:
        """Whether a mass has the inertia of the scene's machine."""
        return any(mass.inertia is None for mass in self.masses.values())

    def _check_excitations(self) -> None:
        for key, mass in (("load", self.load), ("machine_at", self.machine_at)):
            if mass is not None and mass not in self.masses:
                raise ValueError(f"{key}: there is no mass {mass!r}; masses are {', '.join(self.masses)}")
        for name, excitation in self.excitations.items():
            if excitation.on not in self.masses:
                known = ", ".join(self.masses)
                raise ValueError(f"excitations.{name}.on: there is no mass {excitation.on!r}; masses are {known}")
        given = [key for key in ("speed", "engine", "machine_at") if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)}: each of them gives the train's speed; leave all but one out")
        if self.excitations and not given:
            raise ValueError("speed is missing: excitations have orders of it")
        if self.engine is not None:
            self._check_engine(self.engine)
        elif self.cylinders_at:
            raise ValueError("cylinders_at are those of an engine; give engine, or leave them out")

    def _check_engine(self, engine: EngineElement) -> None:
        if engine.gas is None:
            raise ValueError("engine.gas is missing: without it the engine has no torque")
        if len(self.cylinders_at) != engine.cylinders:
            raise ValueError(f"cylinders_at: give a mass for each of the {engine.cylinders} cylinders, in their order")
        unknown = [mass for mass in self.cylinders_at if mass not in self.masses]
        if unknown:
            raise ValueError(f"cylinders_at: there is no mass {unknown[0]!r}; masses are {', '.join(self.masses)}")

    @cached_property
    def layout(self) -> TrainLayout:
        """How masses, shafts and gears hang together.

        Raises
        ------
        LayoutProblem
            They make no tree.
        """
        joints = [Joint(name, *shaft.between, False) for name, shaft in self.shafts.items()]
        joints += [Joint(name, *gear.between, True) for name, gear in self.gears.items()]
        return train_layout(tuple(self.masses), joints)

    @property
    def reported_modes(self) -> int:
        """How many natural frequencies above zero are computed: those asked for, or as many as there are."""
        return min(self.modes, len(self.layout.parents) - (1 if self.layout.is_free else 0))
