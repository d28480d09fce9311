"""The scene's machine on an elastic shaft: results of the drives between its motors and its crank."""

import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.elements.elastic_drives.drive_cycles import (
    drive_results,
    least_and_greatest,
    rounding_scales,
    steps_needed,
)
from engine.elements.elastic_drives.elastic_cycle import (
    GAUSS,
    STAGES,
    STATE,
    DrivenMachine,
    ElasticCycle,
    elastic_cycle,
)
from engine.elements.elastic_drives.elastic_shaft import drive_shaft
from engine.elements.elastic_drives.machine_drive import RESULTS, RUN_RESULTS, VERDICT_KEY, MachineDrive
from engine.elements.element import Answers, named_in_order
from engine.machine.drives.drive_over_angle import drive_over_angle
from engine.mechanism.mechanics import Mechanics
from engine.motion.asked_regimes import TOLERANCE
from engine.motion.coupled.coupled_run import CoupledRuns
from engine.motion.coupled.elastic_run import FINEST, ElasticHistory, run_on_shaft, steps_on_shaft
from engine.motion.coupled.two_sides import OnElasticShaft
from engine.motion.fields.field_instants import FieldInstants
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import Observer, Snapshots
from engine.motion.moments.breaks import GAP, JUMP
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import MachineSystem
from engine.motion.regimes_in_order import RegimesInOrder
from engine.motion.runs.run_progress import ADAPTIVE, Stepping
from engine.motion.settled.steady import steady_motion
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.stepping.records import over_all
from engine.stepping.walk_task import WALKS, range_of_walks
from engine.words.verdicts import Verdict

# Maximum number of values in the curves of variants that are solved together.
TOGETHER = 4_000_000
# Number of crank angles for the mean inertia.
LOOKED_AT = 256
# Relative rounding floors of results, added to the change from half as many steps, and of a multiplier near 1.
ROUNDING = 1e-13
SURE_OF_MULTIPLIER = 1e-9
# The multipliers and the growth rate are the last results of steady running.
_MULTIPLIER = [result.name for result in RESULTS].index("multiplier")
# Number of steps timed to forecast the duration of a run.
STEPS_TIMED = 100


class ElasticDrives:
    """Drives of a scene's machine through elastic shafts.

    Parameters
    ----------
    mechanics : Mechanics
    drives : sequence of str
        Names of the elements.
    """

    def __init__(self, mechanics: Mechanics, drives: Sequence[str]) -> None:
        self.scene = mechanics.scene
        self.drives: dict[str, MachineDrive] = {name: self.scene.elements[name] for name in drives}
        self._in_order = RegimesInOrder(mechanics, set(), 2)
        reduction = self._in_order.reduction
        gathered = frozenset({"fading"})
        made = {
            name: Dynamics(reduction, frozenset(drive.off), gathered=gathered) for name, drive in self.drives.items()
        }
        self.dynamics = made
        runs = {name: drive.run for name, drive in self.drives.items() if drive.run is not None}
        self.runs = {name: OnElasticShaft(reduction, frozenset(run.off)) for name, run in runs.items()}
        self.nodes = reduction.nodes
        motors, loads = frozenset(reduction.loads.motors), frozenset(load.action for load in reduction.loads.terms)
        self._over_angle = MachineSystem(*drive_over_angle(mechanics, motors, loads), mechanics)

    def numbers(self, numbers: Numbers, sound: np.ndarray) -> dict[str, np.ndarray]:
        """Results of the drives, as numbers of the elements by their paths.

        Parameters
        ----------
        numbers : Numbers
        sound : ndarray (variants,) of bool
            Which variants can be assembled; the others have no results.
        """
        found, who = {}, np.flatnonzero(sound)
        variants = self._in_order.variants(numbers.of_variants(who), who.size)
        for name in self.drives:
            with np.errstate(all="ignore"):
                solved = over_all(self._of(name, variants), who, sound.size)
            for kind, rows in (("value", solved.values), ("error", solved.errors)):
                found |= {f"elements.{name}.machine.{kind}.{key}": row for key, row in rows.items()}
            found[f"elements.{name}.{VERDICT_KEY}"] = solved.verdicts
        return found

    def _of(self, name: str, variants: Variants) -> Answers:
        """Results of a drive with their error estimates, and verdicts, including that on disturbances that grow."""
        values, errors = np.full((2, len(RESULTS) + len(RUN_RESULTS), variants.count), np.nan)
        begin = np.full((4, variants.count), np.nan)
        ready, steps, verdict = self._ready(name, variants)
        for count in np.unique(steps):
            same = np.flatnonzero(steps == count)
            together = max(1, TOGETHER // (count * STAGES * (3 * STATE + STATE**2)))
            for some in np.array_split(same, -(-same.size // together)):
                part, who = ready.some(some), ready.which[some]
                (fine, off, cycle), (coarse, _, _) = (_settled(part, int(n)) for n in (count, count // 2))
                values[: len(RESULTS), who] = fine
                scales = rounding_scales(named_in_order(RESULTS, fine), part.given[:, 0])
                errors[: len(RESULTS), who] = np.abs(fine - coarse) + off + ROUNDING * np.array(list(scales.values()))
                verdict[who] = cycle.verdict
                begin[:, who] = cycle.begin
        if name in self.runs:
            self._add_run(name, ready, begin, values, errors, verdict)
        grows = values[_MULTIPLIER] > 1.0 + errors[_MULTIPLIER] + SURE_OF_MULTIPLIER
        verdict[(verdict == Verdict.OK) & grows] = Verdict.GROWS
        return Answers(*(named_in_order(MachineDrive.results, rows) for rows in (values, errors)), verdict)

    def _add_run(
        self, name: str, ready: "Ready", steady: np.ndarray, values: np.ndarray, errors: np.ndarray, verdict: np.ndarray
    ) -> None:
        """Write the results and verdicts of a run, for variants whose verdict is OK so far."""
        well = np.flatnonzero(verdict[ready.which] == Verdict.OK)
        if not well.size:
            return
        part = ready.some(well)
        steppings = [Stepping(extremes=False, longer=longer) for longer in WALKS]
        runs = [self._run(name, part, steady[:, part.which], stepping) for stepping in steppings]
        every = np.array(
            [(run.peak, run.peak_at, run.shaft_omega, run.omega, run.turned, run.stops, run.closings) for run in runs]
        )
        # Unfinished runs have no results.
        every[0, :, runs[0].verdict != Verdict.OK] = np.nan
        values[len(RESULTS) :, part.which] = every[0]
        errors[len(RESULTS) :, part.which] = range_of_walks(every) + ROUNDING * np.abs(every[0])
        verdict[part.which] = runs[0].verdict

    def seconds_of_runs(self, numbers: Numbers, count: int) -> float:
        """Forecast the computing time of the runs per variant [s], on average, by timing a few steps.

        Parameters
        ----------
        numbers : Numbers
        count : int
            Number of variants.
        """
        variants, seconds = self._in_order.variants(numbers, count), 0.0
        for name in self.runs:
            with np.errstate(all="ignore"):
                ready, _, _ = self._ready(name, variants)
                steps = steps_on_shaft(ready.frequency, self._of_run(name, ready, "time"))
                followed = np.flatnonzero(steps > 0.0)
                if followed.size:
                    of_all = steps.sum() / count * sum(1.0 / longer for longer in WALKS)
                    seconds += of_all * self._seconds_of_step(name, ready.some(followed[:1]))
        return seconds

    def _seconds_of_step(self, name: str, ready: "Ready") -> float:
        """Computing time per step of a drive's run [s]."""
        still, few = np.zeros((4, 1)), STEPS_TIMED * FINEST / ready.frequency
        # The first run may include compiling.
        for _ in range(2):
            begun = time.perf_counter()
            self._run(name, ready, still, duration=np.minimum(few, self._of_run(name, ready, "time")))
            seconds = time.perf_counter() - begun
        return seconds / STEPS_TIMED

    def _of_run(self, name: str, ready: "Ready", key: str) -> np.ndarray:
        """A number of a drive's run, (variants,)."""
        return ready.bare.numbers.of_each(f"elements.{name}.run.{key}", ready.which.size)

    def _run(
        self,
        name: str,
        ready: "Ready",
        steady: np.ndarray,
        stepping: Stepping = ADAPTIVE,
        observers: Sequence[Observer] = (),
        duration: np.ndarray | None = None,
    ) -> CoupledRuns:
        """Simulate a drive's run, or the first part of it, from rest or from a steady state, (4, variants)."""
        run = self.drives[name].run
        angle, whole, backlash = (self._of_run(name, ready, key) for key in ("angle", "time", "backlash"))
        duration = whole if duration is None else duration
        sides = self.runs[name].of(ready.bare, angle, ready.given.T, backlash)
        begin = steady if run.begin == "steady" else np.zeros_like(steady)
        return run_on_shaft(sides, ready.frequency, begin, duration, stepping, observers)

    def _ready(self, name: str, variants: Variants) -> "tuple[Ready, np.ndarray, np.ndarray]":
        """Variants with steady running on a rigid shaft, their numbers of steps, and verdicts on all."""
        dynamics = self.dynamics[name]
        driven = dynamics.driven(variants)
        own, added = self._inertias(name, driven)
        rigid = driven._replace(flywheel=driven.flywheel + added, kept={})
        bare = driven._replace(flywheel=rigid.flywheel - own, kept={})
        steady = steady_motion(dynamics, rigid, TOLERANCE)[0]
        verdict = np.where(dynamics.locked(driven), Verdict.LOCKS, steady.verdict)
        bare_somewhere = dynamics.reduction.without_inertia(bare)
        verdict = np.where((verdict == Verdict.OK) & bare_somewhere, Verdict.NO_INERTIA, verdict)
        who = np.flatnonzero(verdict == Verdict.OK)
        drive, given = self.drives[name], variants.numbers.below(f"elements.{name}")
        n = {key: np.broadcast_to(value, own.shape) for key, value in given.items()}
        shaft = drive_shaft(drive, n | {"motor_inertia": own, "load_inertia": dynamics.mean_inertia(bare, LOOKED_AT)})
        given = np.stack([shaft.stiffness, shaft.damping, own], axis=1)[who]
        ready = Ready(dynamics, self._over_angle, rigid.some(who), bare.some(who), given, shaft.frequency[who], who)
        steps = steps_needed(ready.frequency, dynamics.cycle / steady.period[who], dynamics.cycle)
        return ready, steps, verdict.astype(np.uint8)

    def as_is(self, name: str) -> "tuple[Ready, ElasticCycle, DrivenMachine, RigidCycle] | None":
        """The scene's own values on one of the shafts, in steady running; None without steady running."""
        ready, steps, _ = self._ready(name, self._in_order.variants(Numbers(scene_numbers(self.scene), {}), 1))
        if not steps.size:
            return None
        machine, guess, rigid = _machine_over_cycle(ready, int(steps[0]))
        found = elastic_cycle(machine, ready.given, guess)
        return None if found.verdict[0] != Verdict.OK else (ready, found, machine, rigid)

    def history(self, name: str) -> np.ndarray | None:
        """Time, state as in `run_on_shaft` and torque along the run at the scene's own values; None without one."""
        found = self.as_is(name) if name in self.runs else None
        if found is None:
            return None
        seen = ElasticHistory()
        self._run(name, found[0], found[1].begin, observers=[seen])
        return seen.rows

    def _inertias(self, name: str, variants: Variants) -> tuple[np.ndarray, np.ndarray]:
        """Inertia at the motor end, reduced to the crank, and the part of it that isn't in the scene."""
        n, drive = variants.numbers, self.drives[name]
        if drive.driver is None:
            own = n.of_each(f"elements.{name}.motor_inertia", variants.count)
            return own, own
        own, ratio = (n.of_each(f"shafts.{drive.driver}.{key}", variants.count) for key in ("inertia", "ratio"))
        return own * ratio**2, np.zeros(variants.count)


class DriveCycle(NamedTuple):
    """Steady running of a machine on an elastic shaft over its cycle, (positions,): the ends of every step.

    Attributes
    ----------
    angle : ndarray
        Crank angle turned [rad].
    moment, rigid_moment : ndarray
        Torque of the shaft, and of a rigid shaft in its own steady running [N·m].
    motor_speed, machine_speed, rigid_speed : ndarray
        At the motor end, of the crank, and with a rigid shaft [rad/s].
    twist : ndarray
        Angle by which the crank lags [rad].
    """

    angle: np.ndarray
    moment: np.ndarray
    rigid_moment: np.ndarray
    motor_speed: np.ndarray
    machine_speed: np.ndarray
    rigid_speed: np.ndarray
    twist: np.ndarray


def drive_cycle(scene: Scene, name: str) -> DriveCycle | None:
    """Steady running of a scene's machine on the elastic shaft of an element.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the element.

    Returns
    -------
    DriveCycle or None
        None without steady running.
    """
    with np.errstate(all="ignore"):
        found = ElasticDrives(Mechanics(scene), (name,)).as_is(name)
    if found is None:
        return None
    _, cycle, machine, rigid = found
    ends = np.cumsum(machine.steps[0])
    angle = np.concatenate([(ends - machine.steps[0])[:, None], ends[:, None]], axis=1)
    rows = (cycle.moment, rigid.moment, cycle.motor_speed, cycle.machine_speed, rigid.speed, cycle.twist)
    return DriveCycle(angle.ravel(), *(row[0][:, [0, -1]].ravel() for row in rows))


class DriveRun(NamedTuple):
    """A run of a machine on an elastic shaft, (instants,).

    Attributes
    ----------
    time : ndarray
        [s].
    twist : ndarray
        Angle by which the crank lags [rad].
    motor_speed : ndarray
        At the motor end [rad/s].
    angle, machine_speed : ndarray
        Angle turned by the crank [rad], and its speed [rad/s].
    moment : ndarray
        Shaft torque [N·m].
    """

    time: np.ndarray
    twist: np.ndarray
    motor_speed: np.ndarray
    angle: np.ndarray
    machine_speed: np.ndarray
    moment: np.ndarray


def drive_run(scene: Scene, name: str) -> DriveRun | None:
    """The run of a scene's machine on the elastic shaft of an element.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the element.

    Returns
    -------
    DriveRun or None
        None without a run, or without steady running.
    """
    with np.errstate(all="ignore"):
        found = ElasticDrives(Mechanics(scene), (name,)).history(name)
    return None if found is None else DriveRun(*found)


class Ready(NamedTuple):
    """Variants of a drive that can be solved: machines with and without the inertia at the motor end, and shafts.

    Attributes
    ----------
    dynamics : Dynamics
    system : MachineSystem
        System of the drive over the crank angle.
    rigid, bare : Variants
    given : ndarray (variants, 3)
        As for `elastic_cycle`.
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    which : ndarray (variants,) of int
        Their indices among all variants.
    """

    dynamics: Dynamics
    system: MachineSystem
    rigid: Variants
    bare: Variants
    given: np.ndarray
    frequency: np.ndarray
    which: np.ndarray

    def some(self, chosen: np.ndarray) -> "Ready":
        """A subset, by index."""
        rest = (part[chosen] for part in (self.given, self.frequency, self.which))
        return Ready(self.dynamics, self.system, self.rigid.some(chosen), self.bare.some(chosen), *rest)


class RigidCycle(NamedTuple):
    """Torque [N·m] and speed [rad/s] of a rigid shaft at the points of every step, (variants, steps, points).

    `moment_error` estimates the error of the peak torque, (variants,); finer steps don't reveal it.
    """

    moment: np.ndarray
    speed: np.ndarray
    moment_error: np.ndarray


def _settled(ready: Ready, count: int) -> tuple[np.ndarray, np.ndarray, ElasticCycle]:
    """Results (results, variants) with `count` steps, their errors from that of the rigid shaft, and the motion."""
    machine, guess, rigid = _machine_over_cycle(ready, count)
    found = elastic_cycle(machine, ready.given, guess)
    # A jump lies at the middle of its step, across which the curve isn't interpolated.
    jumps = machine.steps < GAP
    first, last = (_at_middle(rigid.moment[..., ::side]) for side in (1, -1))
    least, greatest = least_and_greatest(np.where(jumps[..., None], first[..., None], rigid.moment))
    beyond = np.where(jumps, np.abs(last), 0.0).max(axis=1)
    most = np.fmax(np.fmax(np.abs(least), np.abs(greatest)), beyond)
    results, shifted = (
        drive_results(found, ready.given, ready.frequency, ready.dynamics.cycle, peak)
        for peak in (most, most + rigid.moment_error)
    )
    off = np.abs(shifted - results)
    # Steps longer than half a vibration say nothing about its decay, only that it decays.
    unresolved = ready.frequency * found.sums.period / count > np.pi
    off[_MULTIPLIER:][unresolved & (results[_MULTIPLIER:] < 1.0)] = np.inf
    return results, off, found


def _at_middle(values: np.ndarray) -> np.ndarray:
    """Limits at the middle of steps, on the line through the end and the last point before the middle."""
    last = STAGES // 2
    return values[..., 0] + (values[..., last] - values[..., 0]) * (0.5 / GAUSS.nodes[last - 1])


def _steps_of(variants: Variants, cycle: float, count: int) -> np.ndarray:
    """Steps of a cycle, (steps, variants) [rad]: equal ones with nodes on both sides of every break between.

    A force may jump where its torque has only a kink, as at a dead centre, where the velocity is zero.
    """
    at_breaks = variants.direction * variants.breaks.angles
    # For a break at the start of the cycle, one side is at the end.
    sides = np.mod(np.concatenate((at_breaks - JUMP, at_breaks + JUMP)), cycle)
    # A variant without this break gets the end of the cycle again.
    sides = np.where(sides > 0.0, sides, cycle)
    equal = np.arange(count + 1)[:, None] / count * np.full(variants.count, cycle)
    return np.diff(np.sort(np.concatenate((equal, sides)), axis=0), axis=0)


class _Energy(MotionFields):
    """Only the kinetic energy, as a field of a motion."""

    def __call__(self, states: Snapshots) -> dict[str, np.ndarray]:
        """The energy at states [J], with the inertia of a rigid shaft."""
        places = self.variants.direction[states.who] * states.turned
        return {"energy": 0.5 * self.dynamics.inertia(self.variants, places, states.who) * states.omega**2}


def _machine_over_cycle(ready: Ready, count: int) -> tuple[DrivenMachine, np.ndarray, RigidCycle]:
    """Machines over a cycle of `count` steps, an initial guess of their motion, and their motion on a rigid shaft."""
    dynamics, bare, own = ready.dynamics, ready.bare, ready.given[:, 2]
    steps, variants = _steps_of(bare, dynamics.cycle, count), bare.count
    turned = np.concatenate([np.zeros((1, variants)), np.cumsum(steps, axis=0)])
    within = turned[:-1, None] + steps[:, None] * np.array([0.0, *GAUSS.nodes])[:, None]
    every = np.concatenate([within.reshape(-1, variants), turned[-1:]])
    inertia = dynamics.inertia(bare, bare.direction * every)
    zero = np.zeros(variants)
    seen = [FieldInstants(_Energy(dynamics, ready.rigid, zero, zero, None), ["energy"], every, False) for _ in range(2)]
    steady_motion(dynamics, ready.rigid, TOLERANCE, *([instants] for instants in seen))
    for instants in seen:
        instants.finish(zero, zero + dynamics.cycle, zero + 1.0, zero)
    energy, shifted = (instants.rows["energy"].T for instants in seen)
    equation = EquationOfMotion(dynamics, ready.rigid, zero)

    def torque(turned: np.ndarray, omega: np.ndarray) -> np.ndarray:
        """Torque of the rigid shaft at given speeds."""
        whole = equation.along(turned, omega, np.zeros_like(omega), zero + 1.0)
        return whole.motors - own * whole.epsilon

    omega = np.sqrt(2.0 * energy / (inertia + own))
    rigid_moment = torque(every, omega)
    peak = np.abs(rigid_moment).argmax(axis=0), np.arange(variants)
    moment_error = np.abs(torque(every[peak], omega[peak] * np.sqrt(shifted[peak] / energy[peak])) - rigid_moment[peak])

    def points(values: np.ndarray) -> np.ndarray:
        """Values at the points of every step, including its ends: (variants, steps, points)."""
        begins = values[:-1].reshape(-1, STAGES + 1, variants)
        return np.moveaxis(np.concatenate([begins, values[STAGES + 1 :: STAGES + 1, None]], axis=1), 2, 0)

    rigid = RigidCycle(points(rigid_moment), points(omega), moment_error)
    moment, speed, inertia = rigid.moment[..., 1:-1], rigid.speed[..., 1:-1], points(inertia)
    guess = np.stack([moment, speed, 0.5 * inertia[..., 1:-1] * speed**2], axis=1)
    sizes, direction = ready.system.sizes, bare.direction
    given = dict(zip((sizes.stiffness, sizes.damping, sizes.motor_inertia), ready.given.T, strict=True))
    given |= dynamics.sized(sizes.machine, bare) | dynamics.sized(sizes.motors, bare)
    numbers = ready.system.tabulation.parameters(bare.numbers, direction, bare.ends | given)
    places = (direction * every[:-1]).reshape(-1, STAGES + 1, variants)[:, 1:].reshape(-1, variants)
    machine = DrivenMachine(np.ascontiguousarray(steps.T), places, inertia, ready.system, numbers)
    return machine, guess, rigid
