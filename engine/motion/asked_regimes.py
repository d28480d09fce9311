"""Requested results of a scene's regimes, and the settings that their motions need."""

import numpy as np

from engine.graph.nodes import Node
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.two_sides import TwoSides
from engine.motion.loads import PairLoads
from engine.motion.moments.dynamics import Dynamics, Reduction, Variants
from engine.motion.quantities import (
    AT_SHAFT,
    AXES,
    EFFICIENCY_NOW,
    FIELDS,
    POWERS,
    WORKS,
    Asked,
    kept_at_of,
    kept_fields,
    motion_fields,
    only_motor,
)
from engine.motion.runs.run_progress import TOLERANCE as RUN_TOLERANCE
from engine.parts.regimes import Regime, RunRegime, SteadyRegime, run_keys
from engine.scene.pairs import has_friction, own_drives
from engine.scene.scene import Numbers, Scene, SceneError

# Tolerance of a step in steady running, relative to the maximum work in a step: default, fraction of the requested
# accuracy, minimum.
TOLERANCE, SURER, LEAST_TOLERANCE = 1e-9, 0.1, 1e-13
# Default tolerance of the series of fields, relative to the peak of each.
FIELD_TOLERANCE = 1e-8
# Tolerances of a step in time and of a step over the angle, whose errors are known, relative to the requested accuracy;
# default tolerance over the angle, relative to that in time.
SURER_IN_RUNS, FINER = (0.1, 0.3), 0.03


class AskedRegimes:
    """The regimes of a scene.

    Parameters
    ----------
    mechanics : Mechanics
    asked : set of str
        Summaries and fields, "REGIME.quantity".
    steps : int
        Even number of steps in a cycle.
    accuracy : float, optional
        Requested relative accuracy of the results.

    Attributes
    ----------
    tolerance : float
        Tolerance of a step in steady running, relative to the maximum work in a step.
    field_tolerance : float
        As for `FieldStatistics`.
    loads : PairLoads or None
        Loads on the pairs, if requested.
    keys : RunKeys
        For the kind of input.
    leads : dict of str to str
        Regimes that lead from the end of steady running to an angle at which the next run begins, with that run.
    """

    def __init__(self, mechanics: Mechanics, asked: set[str], steps: int, accuracy: float | None = None) -> None:
        scene = self.scene = mechanics.scene
        self.steps, self.keys = steps, run_keys(scene.input)
        self.leads: dict[str, str] = {}
        self.regimes = self._with_leads()
        _refuse_losses_behind_couplings(scene)
        own = ((name, n) for name, regime in scene.regimes.items() for n in only_motor(scene, regime))
        shaft = ((f"{name}.{key.format(n=n)}", name, key.rpartition("_")[2], n) for name, n in own for key in AT_SHAFT)
        pairs = ((at_shaft, f"{name}.motor_moment_{kind}", n) for at_shaft, name, kind, n in shaft)
        # Torques of motors at their own shafts, with the torques reduced to the input from which they follow.
        self.at_shaft = {name: (reduced, n) for name, reduced, n in pairs if name in asked}
        self.only_for_shafts = {reduced for reduced, _ in self.at_shaft.values()} - asked
        self.asked = asked | self.only_for_shafts
        self._set_tolerances(accuracy)
        self.steady = {name for name, regime in self.regimes.items() if not isinstance(regime, RunRegime)}
        self.needed = self._needed()
        known = {q.name for kind in ("steady", "run") for q in motion_fields(mechanics, kind)}
        known |= {q.name for q in kept_fields(mechanics)}
        self.instants = kept_at_of(scene)
        fields = [one for one in map(Asked.of, sorted(self.asked)) if f"{one.regime}.{one.field}" in known]
        self.fields = {name: [one for one in fields if one.regime == name] for name in self.regimes}
        loads = {one.field for one in fields} - FIELDS.keys() - AXES.keys()
        self.loads = PairLoads(mechanics, loads) if loads else None
        works, gathered = self._integrals({one.field for one in fields})
        sets = dict.fromkeys(frozenset(self.regimes[name].off) for name in self.needed)
        self.reduction, rubs = Reduction(mechanics), has_friction(scene)
        self.dynamics = {off: Dynamics(self.reduction, off, works, rubs, gathered) for off in sets}
        self.sides = {off: TwoSides(self.reduction, off, works, rubs) for off in sets} if scene.couplings else {}
        self._refuse_equal_steps()

    def _with_leads(self) -> dict[str, Regime]:
        """The regimes of the scene, and `leads`, without which the speed at the beginning of a run isn't known."""
        found, before = {}, None
        for name, regime in self.scene.regimes.items():
            own = getattr(regime, self.keys.from_place, None), getattr(regime, self.keys.from_speed, None)
            if isinstance(before, SteadyRegime) and own[0] is not None and own[1] is None:
                lead = f"up to {name}"
                self.leads[lead], found[lead] = name, RunRegime(type="run", off=before.off, cycles=1.0)
            found[name] = before = regime
        return found

    def _set_tolerances(self, accuracy: float | None) -> None:
        self.tolerance = TOLERANCE if accuracy is None else max(SURER * accuracy, LEAST_TOLERANCE)
        self.field_tolerance = FIELD_TOLERANCE if accuracy is None else self.tolerance
        self.run_tolerance = RUN_TOLERANCE, FINER * RUN_TOLERANCE
        if accuracy is not None:
            self.run_tolerance = tuple(max(share * accuracy, LEAST_TOLERANCE) for share in SURER_IN_RUNS)

    def _integrals(self, fields: set[str]) -> tuple[bool, frozenset[str]]:
        """Whether the work of each kind of load is integrated, and what else is."""
        summaries = {name.rpartition(".")[2] for name in self.asked}
        works = not summaries.isdisjoint((*WORKS, "efficiency", "work_residual"))
        works |= not fields.isdisjoint(("motors_power", *POWERS, EFFICIENCY_NOW))
        gathered = {"motors"} if works or summaries & {"motor_work", "motor_power"} else set()
        gathered |= {"fading"} if self.steady & set(self.needed) else set()
        gathered |= {"squares"} if "motor_moment_rms" in summaries else set()
        return works, frozenset(gathered)

    @property
    def nodes(self) -> list[Node]:
        """Nodes from which the motion and the requested loads are computed at a position."""
        return [*self.reduction.nodes, *(self.loads.nodes if self.loads else ())]

    def _refuse_equal_steps(self) -> None:
        """Raise SceneError if a run names a method of equal steps but cannot be computed over the crank angle."""
        for name in self.needed:
            regime = self.regimes[name]
            if name in self.steady or regime.method is None:
                continue
            timed = self.dynamics[frozenset(regime.off)].timed
            there = {
                "an input that doesn't turn fully": not self.scene.has_cycle,
                "the two speeds of a coupling": bool(self.sides),
                "friction in pairs": has_friction(self.scene),
                "a second input with its own drive": bool(own_drives(self.scene)),
                "moments that depend on time": timed,
            }
            hindrances = [words for words, found in there.items() if found]
            if hindrances:
                message = f"equal steps over the crank angle can't follow {hindrances[0]}; leave method, steps_per_turn"
                raise SceneError([(f"regimes.{name}.method", message)])

    def _needed(self) -> list[str]:
        """Requested regimes, and the runs before them that set their initial state."""
        wanted = {name.partition(".")[0] for name in self.asked}
        needed, pending = [], False
        for name, regime in reversed(self.regimes.items()):
            if name in wanted or pending:
                needed.append(name)
                pending = isinstance(regime, RunRegime) and not self.begins_anew(regime)
        return needed[::-1]

    def begins_anew(self, regime: RunRegime) -> bool:
        """Whether a run specifies its initial position and speed, and so needs no previous regime; its clock is 0."""
        return None not in (getattr(regime, self.keys.from_speed), getattr(regime, self.keys.from_place))

    def variants(self, numbers: Numbers, count: int) -> Variants:
        """A number of variants, with the flywheel of the scene."""
        has_wheel = "flywheel.inertia" in numbers
        flywheel = numbers.of_each("flywheel.inertia", count) if has_wheel else np.zeros(count)
        return self.reduction.variants(numbers, np.sign(numbers.of_each("input.speed", count)), flywheel)


def _refuse_losses_behind_couplings(scene: Scene) -> None:
    for coupling in scene.couplings.values():
        if scene.shafts[coupling.shaft].efficiency is not None:
            message = "mesh losses between a coupling and the crank aren't computed in regimes; leave it out"
            raise SceneError([(f"shafts.{coupling.shaft}.efficiency", message)])
