"""The history of one machine through its regimes: angle, speed, moments and energy over time."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from engine.machine.judgement import failures_within
from engine.machine.measuring import Measuring
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import load_fields, sized_regimes
from engine.motion.regimes_in_order import RegimesInOrder
from engine.motion.runs.run_progress import CoupledStanding, Standing
from engine.motion.runs.watching import Piece, RunFields
from engine.motion.settled.steady_with_friction import settled_motion
from engine.quantities.quantity import Quantity
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.words.verdicts import Verdict

_ZERO = np.zeros(1)
# Nodes of a history whose fields are computed together.
MOST_TOGETHER = 50_000
# Rows of pieces of a motion at their nodes.
AT_NODES = ("time", "turned", "omega", "moving", "moment")
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
        Of the crank [rad/s, rad/s²], positive counter-clockwise.
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
        raise ValueError(f"{unknown[0]!r} isn't a load that a history keeps; there are: {', '.join(known)}")
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
        if hindered.any():
            along = RunFields(dynamics, variants, standing.angle, standing.clock, motion.loads, dynamics.off)
            parts.append(_Part(name, begun, along, [_instant(standing)]))
            standing = standing._replace(verdict=hindered)
            break
        records: list[_Record] = []

        def record(along: RunFields, *_: object, records: list[_Record] = records) -> _Record:
            records.append(_Record(along))
            return records[-1]

        if not motion.is_steady or motion.at_two_speeds:
            if motion.is_steady:
                _, outcome, standing = motion.settled_at_two_speeds(variants, standing, record=record)
            else:
                outcome, _, standing = motion.run(variants, standing, record=record)
            pieces, state = records[0].pieces, outcome.state
            if not pieces:
                break
            if state.time[0] > pieces[-1].time[-1, 0] and motion.two is None:
                # It was at rest until the end of the time.
                pieces.append(_instant(standing, state.time, state.turned))
            parts.append(_Part(name, begun, records[0].along, pieces))
            begun += pieces[-1].time[-1, 0]
        else:
            variants, verdict = motion.with_sized_flywheel(variants)
            piece, standing = _one_cycle(dynamics, variants, steps, in_order.tolerance)
            standing = standing._replace(verdict=np.maximum(standing.verdict, verdict))
            along = RunFields(dynamics, variants, zero, zero, motion.loads, dynamics.off)
            sides = None if motion.two is None else motion.two.of(variants, zero)
            if sides is not None:
                standing = standing._replace(coupled=CoupledStanding(standing.omega, np.full(1, np.inf)))
            parts.append(_Part(name, begun, along, [piece], sides))
            begun += piece.time[-1, 0]
        if standing.verdict[0] != Verdict.OK:
            break
    found = _gathered(parts, fields, Verdict(int(standing.verdict[0])))
    return _up_to_failure(found, Measuring(mechanics, (), (), (), (steps, steps + 1), None, in_order.nodes), numbers)


def history_fields(scene: Scene) -> dict[str, Quantity]:
    """Loads on the pairs and on the frame that a history may keep, by name."""
    return _fields_of(Mechanics(scene))


def _fields_of(mechanics: Mechanics) -> dict[str, Quantity]:
    made = load_fields(mechanics).items()
    return {name: Quantity(name, words.format(name="its regimes"), unit) for name, (words, unit) in made}


class _Record:
    """Keeps all pieces of a run of one variant."""

    def __init__(self, along: RunFields) -> None:
        self.along = along
        self.pieces: list[Piece] = []

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Keep a piece."""
        self.pieces.append(piece)


class _Part(NamedTuple):
    """A regime: name, start time [s], fields and pieces, and the sides of a coupling that holds."""

    name: str
    begun: float
    along: RunFields
    pieces: list[Piece]
    sides: CoupledSides | None = None


def _instant(standing: Standing, time: np.ndarray = _ZERO, turned: np.ndarray = _ZERO) -> Piece:
    """State of a machine as a piece, a certain time and angle after the start of its run."""
    rows = [time[None], turned[None], standing.omega[None]]
    return Piece(*rows, np.ones(1), np.empty((0, 1)), np.full((1, 1), np.nan))


def _one_cycle(dynamics: Dynamics, variants: Variants, steps: int, tolerance: float) -> tuple[Piece, Standing]:
    zero = np.zeros(1)
    grid = dynamics.grid(variants, zero, steps)
    places = grid.angles
    steady = settled_motion(dynamics, variants, tolerance, 1.0, variants.direction * places)
    energy, time, moment = steady.record
    omega = np.sqrt(2.0 * energy / dynamics.inertia(variants, places))
    piece = Piece(time, variants.direction * places, omega, np.ones(1), grid.steps, moment)
    return piece, Standing(zero, omega[0], zero, steady.verdict)


def _gathered(parts: list[_Part], fields: Iterable[str], verdict: Verdict) -> History:
    columns: dict[str, list[np.ndarray]] = {}
    for part in parts:
        for own in _of_pieces(part, fields):
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


def _of_pieces(part: _Part, fields: Iterable[str]) -> Iterator[dict[str, np.ndarray]]:
    """Columns of a regime, in groups of pieces."""
    name, begun, along, pieces, sides = part
    sense = along.variants.direction[0]
    for piece, new in _joined(pieces):
        rows = {key: row[new, 0] for key, row in along(np.zeros(1, int), piece).items()}
        none = np.full(new.sum(), np.nan)
        own = {
            "regime": np.full(new.sum(), name),
            "time": begun + piece.time[new, 0],
            "angle": along.start[0] + sense * piece.turned[new, 0],
            "shaft_speed": none if sides is None else sides.coupling.ratio * rows["speed"],
            "coupling_moment": none,
            "coupling power": np.zeros(new.sum()),
        }
        moments = (rows["motor_moment"], *(rows[channel] for channel in CHANNELS))
        # The moments of a regime that can't start may be NaN.
        with np.errstate(invalid="ignore"):
            own |= {f"{name} power": sense * m * rows["speed"] for name, m in zip(SOURCES, moments, strict=False)}
        own |= {key: row for key, row in rows.items() if key.endswith(" power")}
        own |= {"speed": sense * rows["speed"]} | {key: row for key, row in rows.items() if key in AT_TWO_SPEEDS}
        kept = ("acceleration", "motor_moment", *CHANNELS, *fields)
        yield own | {"energy": rows["kinetic_energy"]} | {key: rows[key] for key in kept}


def _joined(pieces: list[Piece]) -> Iterator[tuple[Piece, np.ndarray]]:
    """Pieces of one variant in order, joined where they are alike, and which of their nodes are new."""
    news = (_new_nodes(piece, before) for before, piece in zip([None, *pieces], pieces, strict=False))
    own: list[Piece] = []
    new: list[np.ndarray] = []
    for piece, its in zip(pieces, news, strict=True):
        alike = own and all(np.array_equal(*rows) for rows in zip(piece.held, own[0].held, strict=True))
        if own and not (alike and sum(each.size for each in new) + its.size <= MOST_TOGETHER):
            yield _in_one(own), np.concatenate(new)
            own, new = [], []
        own.append(piece)
        new.append(its)
    yield _in_one(own), np.concatenate(new)


def _in_one(pieces: list[Piece]) -> Piece:
    """Join pieces of the same directions, to evaluate fields at their nodes."""
    names = set(AT_NODES) & set(pieces[0]._fields)
    rows = {name: np.concatenate([getattr(piece, name) for piece in pieces], axis=-2) for name in names}
    return pieces[0]._replace(**rows)


def _new_nodes(piece: Piece, before: Piece | None) -> np.ndarray:
    """Which nodes of a piece are new, (nodes,) of bool: without repeated nodes or the end of the piece before it."""
    states = np.stack((piece.time[:, 0], piece.turned[:, 0], piece.omega[:, 0]))
    new = np.concatenate(([True], (np.diff(states, axis=1) != 0.0).any(axis=0)))
    # A motion whose end was not found remains a row of NaN.
    if before is not None:
        new[0] = (before.time[-1, 0], before.turned[-1, 0]) != (piece.time[0, 0], piece.turned[0, 0])
    return new
