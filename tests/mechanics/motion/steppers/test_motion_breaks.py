"""Where moments jump and bend: places against the slider-crank's closed form."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from motion_scenes import CUT, INERTIA, RADIUS, ROD, ask, rotor, run, slider_crank, steady

from engine import Scene
from engine.mechanism.mechanics import Mechanics
from engine.motion.moments.dynamics import Reduction
from engine.scene.scene import Numbers, scene_numbers

TURN = 2 * math.pi
# Regula falsi goes down to rounding: of a slide of 0.25 m whose slope is 0.02 m and more a radian, and of q itself.
FOUND = 2e-14


def landmarks(scene: dict, varied: dict | None = None) -> tuple:
    """Ends of strokes by their names and breaks by action, (places, variants), and which jump."""
    varied = {path: np.array(values, float) for path, values in (varied or {}).items()}
    scene = Scene.model_validate(scene)
    reduction = Reduction(Mechanics(scene, frozenset(varied)))
    count = len(next(iter(varied.values()), [0]))
    ends, breaks = reduction.landmarks(Numbers(scene_numbers(scene), varied), np.ones(count))
    return {node.which: values for node, values in ends.items()}, breaks


def of(breaks: object, action: str, variant: int = 0) -> list[tuple[float, bool]]:
    """Angles of an action's breaks within the turn, in order, and whether each is a jump."""
    chosen = breaks.of(frozenset({action}))
    rows = zip(np.mod(chosen.angles[:, variant], TURN), chosen.jumps, strict=True)
    # A break at the very begin may be found at either end of the turn.
    return sorted((0.0 if a > TURN - 1e-12 else float(a), bool(j)) for a, j in rows if not math.isnan(a))


def angle_at(x: float, rod: float = ROD) -> float:
    """Crank angle in (0, π) at which the slide coordinate is x, by the law of cosines."""
    return math.acos((RADIUS**2 + x * x - rod * rod) / (2 * RADIUS * x))


def check(found: list[tuple[float, bool]], expected: list[tuple[float, bool]], tolerance: float = FOUND) -> None:
    assert [jump for _, jump in found] == [jump for _, jump in expected]
    assert [a for a, _ in found] == pytest.approx([a for a, _ in expected], abs=tolerance)


@pytest.mark.parametrize("measured", ["high end", "low end", "guide"])
def test_table_over_stroke__dead_centres_and_rows(measured):
    scene = slider_crank({})
    shift = {"high end": 0.0, "low end": 0.0, "guide": ROD - 0.01}[measured]
    scene["forces"] = {
        "cut": CUT
        | {
            "measured_from": measured,
            "over_stroke": [0.01 + shift, 0.015 + shift, 0.02 + shift],
            "force": [900.0, 600.0, 0.0],
        }
    }
    ends, breaks = landmarks(scene)
    known = {"high end": {"high": ROD + RADIUS}, "low end": {"low": ROD - RADIUS}, "guide": {}}[measured]
    assert {which: end[0] for which, end in ends.items()} == pytest.approx(known, rel=1e-15)
    level = {"high end": lambda x: ROD + RADIUS - x, "low end": lambda x: ROD - RADIUS + x, "guide": lambda x: x}
    places = [angle_at(level[measured](x)) for x in scene["forces"]["cut"]["over_stroke"]]
    # 900 N break off, 600 N is a bend, and so is the end with 0 N.
    jumps = [True, False, False]
    # The cut acts on one way only, the second half of the turn.
    rows = [(TURN - a, j) for a, j in zip(places, jumps, strict=True)]
    check(of(breaks, "cut"), sorted(rows))


def test_table_from_the_end_of_the_stroke__bends_at_the_dead_centre_however_that_is_rounded():
    # Next to the dead centre the stroke is 1e-20 m from its end, and by rounding may be beyond it, where nothing acts.
    scene, offsets = slider_crank({}), np.linspace(-0.03, 0.03, 60)
    scene["guides"]["way"]["y"] = 0.0
    scene["forces"] = {"cut": CUT | {"over_stroke": [0.0, 0.02], "force": [900.0, 500.0]}}
    _, breaks = landmarks(scene, {"guides.way.y": offsets})
    for i, offset in enumerate(offsets):
        angle = np.mod(math.asin(offset / (RADIUS + ROD)), TURN)
        beside = [abs(math.remainder(a - angle, TURN)) for a, jump in of(breaks, "cut", i) if not jump]
        assert min(beside) < FOUND


def test_table_over_angle__its_rows():
    _, breaks = landmarks(slider_crank({}))
    found = of(breaks, "by_angle")
    # The first row and the last are the same place.
    assert {round(a, 12) for a, _ in found} == {0.0, 1.0, 4.0}
    assert [jump for a, jump in found if abs(a - 1.0) < 1e-12] == [True]


def test_friction_force__bends_at_dead_centres():
    scene = slider_crank({})
    scene["forces"] = {"ways": {"type": "against_motion", "on": "B", "angle": 0.0, "force": 30.0}}
    _, breaks = landmarks(scene)
    check(of(breaks, "ways"), [(0.0, False), (math.pi, False)])


def test_friction_that_fades_with_the_speed__bends_at_dead_centres_too():
    scene = slider_crank({})
    force = "-sign(v) * (20 N + 30 N * exp(-abs(v) / (0.1 m/s)))"
    scene["forces"] = {"ways": {"type": "formula", "on": "B", "angle": 0.0, "force": force}}
    _, breaks = landmarks(scene)
    check(of(breaks, "ways"), [(0.0, False), (math.pi, False)])


@pytest.mark.parametrize("head", ["high", "low"])
def test_compressor_valves__where_the_polytropes_reach_the_lines(head):
    scene = slider_crank({})
    scene["forces"] = {}
    gas = {"clearance": 0.06, "suction": 1.0e5, "discharge": 5.0e5, "n_compression": 1.3, "n_expansion": 1.2}
    scene["cylinders"] = {"gas": {"type": "compressor", "piston": "ram", "bore": 0.08, "head": head, **gas}}
    rods = [0.12, 0.2, 0.5]
    _, breaks = landmarks(scene, {"groups.drive.first.length": rods})
    stroke = 2 * RADIUS
    least = gas["clearance"] * stroke
    opens = (stroke + least) * (gas["suction"] / gas["discharge"]) ** (1 / gas["n_compression"]) - least
    closes = least * (gas["discharge"] / gas["suction"]) ** (1 / gas["n_expansion"]) - least
    for i, rod in enumerate(rods):

        def place(travel: float, rod: float = rod) -> float:
            return angle_at(rod + RADIUS - travel if head == "high" else rod - RADIUS + travel, rod)

        # Delivery opens on the way to the head, suction on the way from it; each level is passed twice.
        both = [place(opens), place(closes)]
        expected = sorted([0.0, math.pi, *both, *(TURN - a for a in both)])
        check(of(breaks, "gas", i), [(a, False) for a in expected], 1e-13)


def test_breaks_of_variants__each_its_own():
    depths = [0.15, 0.2, 0.4, 1.0]
    _, breaks = landmarks(slider_crank({}), {"groups.drive.first.length": depths})
    for i, rod in enumerate(depths):
        places = [angle_at(rod + RADIUS - x, rod) for x in CUT["over_stroke"]]
        rows = [(TURN - a, True) for a in places]
        check(of(breaks, "cut", i), sorted(rows), 1e-13)


def test_stroke_too_short_for_a_table__has_no_such_break():
    scene = slider_crank({})
    scene["forces"]["cut"] = CUT | {"over_stroke": [0.01, 0.5]}
    _, breaks = landmarks(scene)
    place = angle_at(ROD + RADIUS - 0.01)
    # From there to the dead centre, and the way back is without load.
    check(of(breaks, "cut"), [(math.pi, False), (TURN - place, True)])


# A sawtooth: it jumps where the cycle begins.
SAWTOOTH = {"over_angle": [0.0, 3.0, TURN, TURN], "moment": [1.0, 2.0, 6.0, 1.0]}


def test_jump_where_the_cycle_begins__is_a_break_like_any_other():
    _, breaks = landmarks(slider_crank({}, by_angle=SAWTOOTH))
    assert of(breaks, "by_angle") == [(0.0, True), (3.0, False)]


@pytest.mark.parametrize("start", [2.0, 0.0, TURN, 3.0])
def test_run_over_a_turn__gains_the_area_of_the_table_wherever_it_begins(start):
    scene = rotor({"go": run("by_angle", from_speed=20.0, from_angle=start, cycles=2.0)}, by_angle=SAWTOOTH)
    found = ask(scene, "go.energy_change", 60)
    # Of a moment that is straight between nodes Simpson's rule makes no error; at a jump a node is off by 1e-10.
    area = 3.0 * 1.5 + (TURN - 3.0) * 4.0
    assert found["go.energy_change"] == pytest.approx(2.0 * area, abs=1e-9)


def test_steady_motion_with_a_jump_where_the_cycle_begins__balances_its_works():
    scene = rotor({"go": steady("by_angle dc")}, by_angle=SAWTOOTH)
    found = ask(scene, "go.motor_work", 60)
    # What the table gives in a turn, the motor takes; rounding of works of some 40 J on the way.
    assert found["go.motor_work"] == pytest.approx(-(3.0 * 1.5 + (TURN - 3.0) * 4.0), abs=1e-9)


def test_tables__have_breaks_at_all_rows_however_smoothly_joined():
    rows = {"over_stroke": [0.01, 0.015, 0.02, 0.03], "force": [0.0, 600.0, 500.0, 0.0]}
    for interpolation in ("linear", "pchip", "spline"):
        scene = slider_crank({})
        scene["forces"]["cut"] = CUT | rows | {"interpolation": interpolation}
        assert len(of(landmarks(scene)[1], "cut")) == 4


def area(angles: list[float], moments: list[float]) -> float:
    """Of the straight lines between rows; differences of close angles are exact in fractions."""
    rows = list(zip(map(Fraction, angles), map(Fraction, moments), strict=True))
    return float(sum((m + n) / 2 * (b - a) for (a, m), (b, n) in pairwise(rows)))


# Rows with a break by a distance from another one, or from where the cycle or the run begins.
CLOSE = {
    "after the begin of the cycle": lambda d: ([0, d, d, TURN, TURN], [50, 50, -2, -2, 50], 0.0),
    "before the end of the cycle": lambda d: ([0, TURN - d, TURN - d, TURN, TURN], [50, 50, -2, -2, 50], 0.0),
    "after another": lambda d: ([0, 1, 1, 1 + d, 1 + d, TURN], [5, 5, 1e3, 1e3, 5, 5], 0.0),
    "after the begin of the run": lambda d: ([0, 1, 1, TURN, TURN], [50, 50, -2, -2, 50], 1 - d),
    "before the begin of the run": lambda d: ([0, 1, 1, TURN, TURN], [50, 50, -2, -2, 50], 1 + d),
}


@pytest.mark.parametrize("place", CLOSE)
def test_breaks_however_close__give_their_work(place):
    distances = 10.0 ** np.random.default_rng(7).uniform(-13.0, -8.0, 8)
    for d in distances:
        angles, moments, begin = CLOSE[place](float(d))
        # The second one goes in time, as something may depend on it.
        regimes = {"angle": run("by_angle", from_speed=20.0, from_angle=begin, cycles=1.0)}
        regimes["time"] = regimes["angle"] | {"only": "by_angle nothing"}
        found = ask(
            rotor(regimes, by_angle={"over_angle": angles, "moment": moments}), "angle.final_speed time.final_speed"
        )
        true = math.sqrt(20.0**2 + 2.0 * area(angles, moments) / INERTIA)
        for name in ("angle.final_speed", "time.final_speed"):
            assert abs(found[name] - true) <= found.figure(name), (name, d)


def test_cycle_of_many_turns__cuts_as_often_as_one_of_one():
    names = "required_power input_moment.max on.motor_work go.final_speed"
    found = {}
    for turns in (1, 7, 24):
        regimes = {"on": steady("dc cut gravity"), "go": run("cut gravity", from_speed=30.0, cycles=2.0 / turns)}
        scene = slider_crank(regimes, flywheel=0.4)
        scene["input"]["revolutions"], scene["moments"] = turns, {"dc": scene["moments"]["dc"]}
        scene["regimes"]["on"]["off"], scene["regimes"]["go"]["off"] = [], ["dc"]
        found[turns] = ask(scene, names)
    for turns in (7, 24):
        assert found[turns]["on.motor_work"] == pytest.approx(turns * found[1]["on.motor_work"], rel=1e-8)
        for name in names.split():
            if name != "on.motor_work":
                assert found[turns][name] == pytest.approx(found[1][name], rel=1e-9), name
