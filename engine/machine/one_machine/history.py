"""The history of one machine through its regimes: angle, speed, moments and energy over time."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from engine.machine.judging.judgement import failures_within
from engine.machine.measuring.measuring import Measuring
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import TIME, TURNED, RecordedMotion, at_instant
from engine.motion.moments.breaks import JUMP
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import load_fields, sized_regimes
from engine.motion.regimes_in_order import RegimesInOrder
from engine.motion.settled.steady_with_friction import settled_motion
from engine.motion.steady_motions import SteadyAtOneSpeed, SteadyAtTwoSpeeds
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.stepping.records import elements_of_counts
from engine.words.quantity import Quantity
from engine.words.verdicts import Verdict

# Nodes of a history whose fields are computed together.
MOST_TOGETHER = 50_000
# Minimum number of intervals between nodes in a step over time; multiples of the spacing are met this closely; instants
# that differ by this fraction are one.
LEAST_INTERVALS, AT_MULTIPLE, SAME_TIME = 8, 1e-9, 1e-13
# Sources and sinks of power.
SOURCES = ("motors", *CHANNELS, "coupling")
# Quantities that the two sides of a coupling have separately.
AT_TWO_SPEEDS = ("shaft_speed", "coupling_moment", *(f"{source} power" for source in SOURCES))


class History(NamedTuple):
    """The history of a machine through its regimes; arrays (instants,).

    Attributes
    ----------
    regime : ndarray of str
        Name of the regime at each instant.
    time : ndarray
        Time after the start of the first regime [s]; a steady regime is shown for one cycle.
    angle : ndarray
        Crank angle [rad], continuing beyond a turn.
    speed, acceleration : ndarray
        Speed and acceleration of the crank [rad/s, rad/s²], positive counter-clockwise.
    motor_moment : ndarray
        Motor torque reduced to the crank [N·m].
    load_moments : dict of str to ndarray
        Reduced moment by role: "driving", "useful", "harmful", "braking", "other" [N·m].
    energy : ndarray
        Kinetic energy [J].
    loads_on_pairs : dict of str to ndarray
        Requested loads on pairs and frame, by name [N, N·m].
    powers : dict of str to ndarray
        Power of the "motors", by role as in `load_moments`, and of the "coupling", which is heat [W].
    shaft_speed, coupling_moment : ndarray
        Speed of the shaft behind a coupling [rad/s], and the torque that the coupling transmits to the crank, reduced
        to it [N·m]; NaN without a coupling; the torque is also NaN in steady running.
    verdict : Verdict
        If it isn't OK, the history ends where the motion did; a regime that reaches a position at which a group is
        singular, or can't be assembled, keeps its first instant only.
    """

    regime: np.ndarray
    time: np.ndarray
    angle: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    motor_moment: np.ndarray
    load_moments: dict[str, np.ndarray]
    energy: np.ndarray
    loads_on_pairs: dict[str, np.ndarray]
    powers: dict[str, np.ndarray]
    shaft_speed: np.ndarray
    coupling_moment: np.ndarray
    verdict: Verdict


def history(scene: Scene, steps: int = 360, fields: Iterable[str] = ()) -> History:
    """Compute the regimes of a scene over time, steady ones with the flywheel that is sized for them.

    Parameters
    ----------
    scene : Scene
        With at least one regime.
    steps : int
        Steps per cycle; even.
    fields : iterable of str
        Additional loads on the pairs and on the frame, such as "input.reaction", from `history_fields`.

    Raises
    ------
    ValueError
        The scene has no regimes, or a field doesn't exist.
    """
    if not scene.regimes:
        raise ValueError("regimes: the scene has none; add [regimes.NAME] with type = 'run' or 'steady'")
    mechanics, fields = Mechanics(scene), tuple(fields)
    known = _fields_of(mechanics)
    unknown = [name for name in fields if name not in known]
    if unknown:
        raise ValueError(f"{unknown[0]!r} isn't a load that a history keeps; allowed: {', '.join(known)}")
    asked = {f"{name}.useful_work" for name in scene.regimes}
    asked |= {f"{name}.{field}.max" for name in scene.regimes for field in fields}
    asked |= {f"{name}.flywheel" for name in sized_regimes(scene)}
    in_order, numbers = RegimesInOrder(mechanics, asked, steps), Numbers(scene_numbers(scene), {})
    every = in_order.variants(numbers, 1)
    zero, standing = np.zeros(1), in_order.at_begin(every)
    parts: list[_Part] = []
    begun = 0.0
    for name, motion in in_order.motions.items():
        dynamics = motion.dynamics
        variants = dynamics.driven(every)
        hindered = motion.hindered(variants)
        if name in in_order.leads:
            standing = motion.run(variants, standing)[2]
            continue
        equation = EquationOfMotion(dynamics, variants, standing.angle)
        if hindered.any():
            along = MotionFields(dynamics, variants, standing.angle, standing.clock, motion.loads)
            parts.append(_Part(name, begun, along, [at_instant(equation, zero, zero, standing.omega)]))
            standing = standing._replace(verdict=hindered)
            break
        record = _Record()
        if isinstance(motion, SteadyAtOneSpeed):
            variants, _, verdict = motion.with_sized_flywheel(variants)
            steady = settled_motion(dynamics, variants, in_order.tolerance, 1.0, record.observers)
            standing = motion.after(variants, steady, np.maximum(steady.verdict, verdict))
            along = MotionFields(dynamics, variants, zero, zero, motion.loads)
            sides = None if motion.two is None else motion.two.of(variants, zero)
            # A motion that was not found is a row of NaN.
            seen = record.motions or [at_instant(equation, zero, zero, standing.omega)]
            parts.append(_Part(name, begun, along, seen, sides))
        else:
            if isinstance(motion, SteadyAtTwoSpeeds):
                _, outcome, standing = motion.settled(variants, standing, record=record.of)
            else:
                outcome, _, standing = motion.run(variants, standing, record=record.of)
            if not record.motions:
                break
            state = outcome.state
            if state.time[0] > record.motions[-1].samples[TIME, -1, -1] and motion.two is None:
                # It was at rest until the end of the time.
                record.see(at_instant(equation, state.time, state.turned, standing.omega))
            parts.append(_Part(name, begun, record.along, record.motions))
        begun += parts[-1].motions[-1].samples[TIME, -1, -1]
        if standing.verdict[0] != Verdict.OK:
            break
    found = _gathered(parts, fields, steps, Verdict(int(standing.verdict[0])))
    return _up_to_failure(found, Measuring(mechanics, (), (), (), (steps, steps + 1), None, in_order.nodes), numbers)


def history_fields(scene: Scene) -> dict[str, Quantity]:
    """Loads on the pairs and on the frame that a history may keep, by name."""
    return _fields_of(Mechanics(scene))


def _fields_of(mechanics: Mechanics) -> dict[str, Quantity]:
    made = load_fields(mechanics).items()
    return {name: Quantity(name, words.format(name="its regimes"), unit) for name, (words, unit) in made}


class _Record:
    """Keeps the recorded motion of one variant, and its fields."""

    def __init__(self) -> None:
        self.along: MotionFields | None = None
        self.motions: list[RecordedMotion] = []

    def see(self, motion: RecordedMotion) -> None:
        """Keep a part of the motion; it replaces a previous state at a single instant if it starts at that instant."""
        if self.motions and (self.motions[-1].samples[TIME] == motion.samples[TIME, 0, 0]).all():
            self.motions.pop()
        self.motions.append(motion)

    def observers(self, who: np.ndarray) -> "list[_Record]":
        """The observer itself, if there is any motion."""
        return [self] if who.size else []

    def of(self, along: MotionFields, *_: object) -> "list[_Record]":
        """The observer itself, of a motion with these fields."""
        self.along = along
        return [self]


class _Part(NamedTuple):
    """A regime: name, start time [s], fields and recorded motion, and the sides of a coupling that holds."""

    name: str
    begun: float
    along: MotionFields
    motions: list[RecordedMotion]
    sides: CoupledSides | None = None


def _gathered(parts: list[_Part], fields: Iterable[str], steps: int, verdict: Verdict) -> History:
    columns: dict[str, list[np.ndarray]] = {}
    for part in parts:
        for own in _of_part(part, fields, steps):
            for key, row in own.items():
                columns.setdefault(key, []).append(row)
    whole = {key: np.concatenate(values) for key, values in columns.items()}
    loads, kept = ({key: whole.pop(key) for key in keys} for keys in (CHANNELS, fields))
    powers = {source: whole.pop(f"{source} power") for source in SOURCES}
    return History(load_moments=loads, loads_on_pairs=kept, powers=powers, verdict=verdict, **whole)


def _up_to_failure(found: History, measuring: Measuring, numbers: Numbers) -> History:
    """A history up to the first regime that reaches a position at which a group fails."""
    for name in dict.fromkeys(found.regime) if measuring.groups else ():
        own = np.flatnonzero(found.regime == name)
        covered = np.array([[np.fmin.reduce(found.angle[own])], [np.fmax.reduce(found.angle[own])]])
        verdict = failures_within(measuring, numbers, covered)[0].verdict[0]
        if verdict != Verdict.OK:
            columns = found._asdict() | {"verdict": Verdict(int(verdict))}
            return History(**{key: _first_rows(column, own[0] + 1) for key, column in columns.items()})
    return found


def _first_rows(column: np.ndarray | dict[str, np.ndarray] | Verdict, count: int) -> object:
    if isinstance(column, dict):
        return {key: row[:count] for key, row in column.items()}
    return column[:count] if isinstance(column, np.ndarray) else column


def _of_part(part: _Part, fields: Iterable[str], steps: int) -> Iterator[dict[str, np.ndarray]]:
    """Columns of a regime, in groups of nodes."""
    name, begun, along, motions, sides = part
    sense, before = along.variants.direction[0], (-np.inf, np.inf)
    low, high = along.dynamics.reduction.range_of(along.variants.numbers, 1)
    for motion in motions:
        step, share, own_nodes = _nodes(motion, (high[0] - low[0]) / steps)
        turned = motion.samples[TURNED][:, step]
        ends = np.where(share == 0.0, turned[0], turned[-1])
        if motion is motions[-1]:
            own_nodes[-1] = True
        for some in np.array_split(np.arange(step.size), -(-step.size // MOST_TOGETHER)):
            states = motion.at(step[some], share[None, some])
            time, turned = states.time[0], states.turned[0]
            at_end = np.isin(share[some], (0.0, 1.0))
            # On either side of a jump, and after a rest.
            later, apart = (np.diff(row, prepend=end) for row, end in zip((time, turned), before, strict=True))
            new = own_nodes[some] | (at_end & (np.abs(turned - ends[some]) > 0.5 * JUMP) & (np.abs(apart) > JUMP))
            new |= (share[some] == 0.0) & ~(later <= SAME_TIME * time)
            before = time[-1], turned[-1]
            count, rows = new.sum(), {key: row[0, new] for key, row in along(states).items()}
            none = np.full(count, np.nan)
            own = {
                "regime": np.full(count, name),
                "time": begun + time[new],
                "angle": along.start[0] + sense * np.where(own_nodes[some] & at_end, ends[some], turned)[new],
                "shaft_speed": none if sides is None else sides.coupling.ratio * rows["speed"],
                "coupling_moment": none,
                "coupling power": np.zeros(count),
            }
            moments = (rows["motor_moment"], *(rows[channel] for channel in CHANNELS))
            # The moments of a regime that can't start may be NaN.
            with np.errstate(invalid="ignore"):
                own |= {f"{name} power": sense * m * rows["speed"] for name, m in zip(SOURCES, moments, strict=False)}
            own |= {key: row for key, row in rows.items() if key.endswith(" power")}
            own |= {"speed": sense * rows["speed"]} | {key: row for key, row in rows.items() if key in AT_TWO_SPEEDS}
            kept = ("acceleration", "motor_moment", *CHANNELS, *fields)
            yield own | {"energy": rows["kinetic_energy"]} | {key: rows[key] for key in kept}


def _nodes(motion: RecordedMotion, spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes of steps: the steps, fractions of these, and whether a node is shown even if nothing jumps there.

    Steps over the angle have nodes at multiples of `spacing`, others about as densely; all have nodes at both ends.
    """
    time, turned = motion.samples[TIME], motion.samples[TURNED]
    reach, multiple = turned[-1] - turned[0], turned[0] / spacing
    counts = np.maximum(LEAST_INTERVALS, np.ceil(np.abs(reach) / spacing)) + 1
    if motion.over_angle:
        before = np.floor(multiple + AT_MULTIPLE)
        counts = np.maximum(np.ceil(turned[-1] / spacing - AT_MULTIPLE) - before - 1, 0) + 2
    # A step may be as short as its rounding.
    counts[(time[-1] == time[0]) | (motion.over_angle & (reach == 0.0))] = 1
    step, k = elements_of_counts(counts.astype(int))
    last = counts[step] - 1
    if not motion.over_angle:
        return step, k / np.maximum(last, 1), (k > 0) | (last == 0)
    inner = ((before[step] + k) * spacing - turned[0, step]) / np.where(last > 0, reach[step], 1.0)
    shown = np.where(k == 0, np.abs(multiple - np.round(multiple))[step] <= AT_MULTIPLE, k < last) | (last == 0)
    return step, np.where(k == 0, 0.0, np.where(k == last, 1.0, inner)), shown
