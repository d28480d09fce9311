"""Second inputs that slide, rest for a while, stand on moving links and rub, against closed forms and 50 digits."""

import math

import five_bars
import mpmath
import numpy as np
import pytest
from driving_cams import BALANCE, asked, changed, rows_of
from each_case import refusals
from geared_links import CRANK
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import moving, rrr
from scipy.interpolate import CubicSpline
from two_bars import joint, power

from engine import Machine, Scene
from engine.machine.results import AskError
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
NODES = 48
SECTIONS = {
    "out": {"type": "rise", "law": "cycloidal", "angle": "100 deg", "lift": 0.06},
    "stay": {"type": "dwell", "angle": "70 deg"},
    "back": {"type": "return", "law": "3-4-5", "angle": "120 deg"},
    "rest": {"type": "dwell"},
}
SLIDING = {"type": "slider", "guide": "way", "start": 0.02, "begin": "40 deg", "sections": SECTIONS}
# A crank and a slider, joined by two bars.
JOINED = {
    "gravity": 9.81,
    "points": {"O": {"x": 0, "y": 0}, "D": {"link": "ram", "x": 0.01, "y": 0.02}},
    "guides": {"way": {"x": 0.2, "y": -0.03, "angle": "25 deg"}},
    "input": CRANK,
    "inputs": {"ram": SLIDING},
    "groups": {"arms": rrr("B", ("left", "A", 0.2), ("right", "D", 0.18))},
    "bodies": {
        "left_body": {"link": "left", "mass": 0.7, "x": 0.09, "inertia": 0.002},
        "right_body": {"link": "right", "mass": 0.8, "x": 0.08, "inertia": 0.003},
        "ram_body": {"link": "ram", "mass": 1.5, "x": 0.01, "y": 0.02, "inertia": 0.002},
    },
}
MOTION = [f"{of}{rate}" for of in ("B.x", "B.y", "ram.slide") for rate in ("", "_phi", "_phiphi")]
DRIVES = ["input_moment_by_equilibrium", "ram.driving_force", "input_moment_by_power", "input_moment"]


def lift(phi: mpmath.mpf, begin: float, reach: float) -> mpmath.mpf:
    """The law of SECTIONS: u − sin(2πu)/2π out, 10u³ − 15u⁴ + 6u⁵ back."""
    degree = mpmath.pi / 180
    turned = (phi - begin) % (2 * mpmath.pi)
    if turned < 100 * degree:
        u = turned / (100 * degree)
        return reach * (u - mpmath.sin(2 * mpmath.pi * u) / (2 * mpmath.pi))
    if turned < 170 * degree:
        return mpmath.mpf(reach)
    u = min((turned - 170 * degree) / (120 * degree), mpmath.mpf(1))
    return reach * (1 - (10 * u**3 - 15 * u**4 + 6 * u**5))


def ends(phi: mpmath.mpf, begin: float, reach: float) -> tuple[mpmath.mpc, ...]:
    """Of the bars of the joined machine, by its loop equation alone, and the direction of the slider."""
    along = mpmath.expj(mpmath.radians(25))
    ram = mpmath.mpc(0.2, -0.03) + (0.02 + lift(phi, begin, reach)) * along
    return mpmath.mpf(CRANK["length"]) * mpmath.expj(phi), ram + mpmath.mpc(0.01, 0.02) * along, mpmath.mpc(1)


@settings(max_examples=6)
@given(st.floats(0.0, 6.2), st.floats(0.01, 0.08), st.floats(1.0, 100.0), st.integers(0, NODES - 1))
def test_slider_with_dwells__moves_as_its_loop_in_50_digits_and_powers_change_the_energy(begin, reach, omega, k):
    numbers = {"inputs__ram__begin": begin, "inputs__ram__sections__out__lift": reach, "input__speed": omega}
    q, rows = asked(changed(JOINED, **numbers), [*MOTION, *DRIVES], NODES)

    def inner(phi: mpmath.mpf) -> mpmath.mpc:
        return joint(*ends(phi, begin, reach)[:2], 0.2, 0.18)

    with mpmath.workdps(50):
        phi = mpmath.mpf(float(q[k]))
        place = inner(phi)
        turned = float((phi - begin) % (2 * mpmath.pi))
        between = np.abs(turned - np.radians([0.0, 100.0, 170.0, 290.0, 360.0])).min() > 1e-6
        slope, bend = (mpmath.diff(inner, phi, n) for n in (1, 2)) if between else (None, None)
        taken = power(lambda t: ends(omega * t, begin, reach), 0.2, 0.18, phi / omega) if between else None
    # Rounding of loops of 0.2 m; of rates by the angles of the sections, 1.7 rad and more.
    for name, value, bound in (("", place, 50), ("_phi", slope, 200), ("_phiphi", bend, 2000)):
        if value is not None:
            found = complex(rows[f"B.x{name}"][k], rows[f"B.y{name}"][k])
            assert abs(found - complex(value)) < bound * EPS
    np.testing.assert_allclose(rows["ram.slide"][k], 0.02 + float(lift(phi, begin, reach)), atol=8 * EPS)
    if taken is not None:
        own, pushing = rows["input_moment_by_equilibrium"], rows["ram.driving_force"] * rows["ram.slide_phi"]
        # Forces of 3 kg at accelerations of up to 0.5 m ω² and that of gravity, on arms of 0.2 m.
        size = 3.0 * (0.5 * omega**2 + 9.81) * 0.2
        assert abs(omega * (own + pushing)[k] - float(taken)) < 1e3 * EPS * omega * size
        np.testing.assert_allclose(own + pushing, rows["input_moment_by_power"], atol=1e3 * EPS * size)
        np.testing.assert_allclose(own + pushing, rows["input_moment"], atol=1e3 * EPS * size)


# Drives on moving links

TURN = {"type": "rise", "law": "cycloidal", "angle": "150 deg", "swing": "80 deg"}
TWO_LINKS = {
    "gravity": 9.81,
    "points": {"O": {"x": 0, "y": 0}},
    "input": CRANK | {"revolutions": 2},
    "inputs": {
        "fore": {
            "type": "crank",
            "pivot": "A",
            "phase": 0.3,
            "ratio": -0.5,
            "harmonics": {"two": {"order": 2, "cosine": 0.1, "sine": 0.2}},
            "sections": {
                "up": TURN,
                "stay": {"type": "dwell"},
                "down": {"type": "return", "law": "cycloidal", "angle": "90 deg"},
            },
        }
    },
    "bodies": {
        "upper": {"link": "crank", "mass": 2.0, "x": 0.03, "inertia": 0.004},
        "lower": {"link": "fore", "mass": 1.2, "x": 0.12, "inertia": 0.005},
    },
}


def cycloidal(turned: np.ndarray, angle: float, stroke: float) -> np.ndarray:
    """Displacement, velocity and acceleration on a section that begins at 0."""
    u = turned / angle
    w = 2 * math.pi
    s = stroke * np.array([u - np.sin(w * u) / w, (1 - np.cos(w * u)) / angle, w * np.sin(w * u) / angle**2])
    return np.where((u >= 0) & (u <= 1), s, 0.0)


def test_two_link_arm__takes_the_moments_of_robotics():
    """Equations of the two-link arm: M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, ch. 7."""
    fields = ["input_moment_by_equilibrium", "fore.driving_moment", "fore.angle", "fore.angle_phi", "fore.angle_phiphi"]
    machine, rows = moving(TWO_LINKS, fields, 2 * NODES)
    (own, second, angle, w, e), q1, omega = rows.values(), machine.q, 4 * math.pi
    q = np.mod(q1, 2 * math.pi)
    up, back, swing = math.radians(150), math.radians(90), math.radians(80)
    down = cycloidal(q - math.radians(270), back, swing)
    down[0] = np.where(q > math.radians(270), swing - down[0], np.where(q > up, swing, 0.0))
    down[1:] *= -1
    law = cycloidal(q, up, swing) + down
    law += 0.1 * np.array([np.cos(2 * q), -2 * np.sin(2 * q), -4 * np.cos(2 * q)])
    law += 0.2 * np.array([np.sin(2 * q), 2 * np.cos(2 * q), -4 * np.sin(2 * q)])
    law += np.array([0.3 - 0.5 * q1, -0.5 + 0 * q, 0 * q])
    # Angles of about ten radians, and products of a few of them.
    np.testing.assert_allclose(np.exp(1j * angle), np.exp(1j * (q1 + law[0])), atol=64 * EPS)
    np.testing.assert_allclose(w, 1 + law[1], atol=64 * EPS)
    np.testing.assert_allclose(e, law[2], atol=64 * EPS)
    l1, d1, d2, m1, m2, j2, g = CRANK["length"], 0.03, 0.12, 2.0, 1.2, 0.005, 9.81
    rate, bend = omega * law[1], omega**2 * law[2]
    h, c = m2 * l1 * d2 * np.sin(law[0]), m2 * l1 * d2 * np.cos(law[0])
    low = m2 * d2 * g * np.cos(q1 + law[0])
    tau2 = (j2 + m2 * d2**2) * bend + h * omega**2 + low
    tau1 = (j2 + m2 * d2**2 + c) * bend - h * (2 * omega * rate + rate**2) + (m1 * d1 + m2 * l1) * g * np.cos(q1) + low
    size = np.abs(tau1).max() + np.abs(tau2).max()
    np.testing.assert_allclose(second, tau2, atol=200 * EPS * size)
    np.testing.assert_allclose(own, tau1, atol=200 * EPS * size)


def test_bead_pushed_along_a_turning_rod__has_its_closed_form_friction_among_it():
    rows, over = [0.05, 0.09, 0.12, 0.07], [0.0, 1.5, 3.0, 4.5]
    scene = {
        "gravity": 9.81,
        "points": {"O": {"x": 0, "y": 0}},
        "guides": {"rod": {"link": "crank", "y": 0.02}},
        "input": CRANK,
        "inputs": {"bead": {"type": "slider", "guide": "rod", "table": {"over_angle": over, "lift": rows}}},
        "bodies": {"bead_body": {"link": "bead", "mass": 0.6}},
        "friction": {"rubs": {"pair": "bead", "coefficient": 0.2}},
    }
    names = ["input_moment_by_equilibrium", "bead.driving_force", "bead.slide", "bead.slide_phi", "bead.slide_phiphi"]
    phi, found = asked(scene, [*names, "input_moment_with_friction"], NODES)
    (own, force, place, slope, bend, whole), omega = found.values(), 4 * math.pi
    spline = CubicSpline([*over, 2 * math.pi], [*rows, rows[0]], bc_type="periodic")
    for order_, found in enumerate((place, slope, bend)):
        np.testing.assert_allclose(found, spline(phi, order_), atol=32 * EPS)
    normal = 0.6 * ((2 * slope - 0.02) * omega**2 + 9.81 * np.cos(phi))
    along = 0.6 * ((bend - place) * omega**2 + 9.81 * np.sin(phi))
    size = 0.6 * (0.3 * omega**2 + 9.81)
    np.testing.assert_allclose(force, along + 0.2 * np.abs(normal) * np.sign(slope), atol=32 * EPS * size)
    np.testing.assert_allclose(own, normal * place - along * 0.02, atol=32 * EPS * size)
    np.testing.assert_allclose(whole, own + force * slope, atol=32 * EPS * size)


INDEX = {
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.2, "y": 0}},
    "input": CRANK | {"revolutions": 4},
    "inputs": {
        "table": {
            "type": "crank",
            "drive": "crank",
            "pivot": "C",
            "phase": 0.2,
            "begin": "60 deg",
            "sections": {
                "on": {"type": "rise", "law": "cycloidal", "angle": "120 deg", "swing": "90 deg"},
                "stay": {"type": "dwell"},
            },
        }
    },
    "bodies": {"plate": {"link": "table", "mass": 3.0, "inertia": 0.05}},
}


def test_index_table__goes_on_by_a_quarter_in_each_turn_and_rests():
    names = ["table.angle", "table.angle_phi", "reduced_inertia", "table.driving_moment", "input_moment_by_equilibrium"]
    machine = Machine(Scene.model_validate(INDEX), [*BALANCE, "reduced_inertia.max"], names, positions=4 * NODES)
    angle, rate, inertia, moment, own, *_ = rows_of(machine).values()
    since = machine.nodes - math.pi / 3
    gone = np.floor(since / (2 * math.pi))
    on, slope, bend = cycloidal(since - 2 * math.pi * gone, 2 * math.pi / 3, math.pi / 2)
    arrived = since - 2 * math.pi * gone > 2 * math.pi / 3
    law = 0.2 + math.pi / 2 * (gone + arrived) + on
    np.testing.assert_allclose(np.exp(1j * angle), np.exp(1j * law), atol=64 * EPS)
    np.testing.assert_allclose(rate, slope, atol=64 * EPS)
    np.testing.assert_allclose(inertia, 0.05 * slope**2, atol=64 * EPS)
    np.testing.assert_allclose(moment, 0.05 * bend * (4 * math.pi) ** 2, atol=1e-12)
    np.testing.assert_allclose(own, moment * slope, atol=1e-12)
    # Twice the mean velocity in the middle of a cycloidal rise.
    greatest = machine.evaluate({}).summaries["reduced_inertia.max"][0]
    assert greatest == pytest.approx(0.05 * (2 * 90 / 120) ** 2, rel=1e-13)


def test_index_table__starts_at_its_begin_in_any_turn():
    """Taken modulo a turn, a begin of −1° would put the table a quarter back."""
    begins = np.radians([-361.0, -359.0, -1.0, 1.0, 359.0, 361.0, 1000.0])
    scene = Scene.model_validate(INDEX | {"points": INDEX["points"] | {"P": {"link": "table", "x": 1.0, "y": 0.0}}})
    machine = Machine(scene, [], ["P.x", "P.y"], ["inputs.table.begin"], 4 * NODES)
    x, y = machine.evaluate({"inputs.table.begin": begins}).fields.values()
    since = machine.nodes - begins[:, None]
    gone = np.floor(since / (2 * math.pi))
    on, _, _ = cycloidal(since - 2 * math.pi * gone, 2 * math.pi / 3, math.pi / 2)
    arrived = since - 2 * math.pi * gone > 2 * math.pi / 3
    law = 0.2 + math.pi / 2 * (gone + arrived) + on
    # The angles' rounding, in up to seven turns.
    np.testing.assert_allclose(x - 0.2 + 1j * y, np.exp(1j * law), atol=64 * EPS)


HARMONICS = {"one": {"order": 1, "cosine": 0.2, "sine": -0.3}, "three": {"order": 3, "cosine": 0.04, "sine": 0.05}}
FIVE_BAR = five_bars.JOINED | {
    "inputs": {"second": {"type": "crank", "pivot": "C", "ratio": -1, "phase": 0.5, "harmonics": HARMONICS}}
}


def test_friction__is_borne_by_both_drives():
    friction = {
        "own": {"pair": "second", "coefficient": 0.1, "diameter": 0.02},
        "inner": {"pair": "arms.inner", "coefficient": 0.15, "diameter": 0.02},
    }
    names = ["input_moment_with_friction", "input_moment_by_equilibrium", "second.driving_moment", "second.angle_phi"]
    whole, own, second, rate = asked(changed(FIVE_BAR, friction=friction), names)[1].values()
    np.testing.assert_allclose(whole, own + second * rate, atol=8 * EPS * (np.abs(own) + np.abs(second * rate)).max())


# Refusals


OUT = {"type": "rise", "law": "cycloidal", "angle": "100 deg", "lift": 0.01}
TOO_FAR = {"out": TURN, "back": {"type": "return", "law": "cycloidal", "swing": "140 deg"}}


test_wrong_laws__are_refused_in_words = refusals(
    lambda changes: Scene.model_validate(changed(JOINED, **changes)),
    ({"inputs__ram__sections__out__swing": 1.0}, "this link slides; give lift"),
    ({"inputs__ram__sections__out__law": "uniform"}, "the velocity jumps"),
    ({"inputs__ram__sections__rest__angle": "10 deg"}, "not to 360 deg"),
    ({"inputs__ram__table": {"over_angle": [0, 1], "lift": [0, 0.01]}}, "one of the two"),
    ({"inputs__ram__sections": {}}, "begin has no meaning without sections or a table"),
    ({"inputs__ram__ratio": 1.0}, "ratio"),
    ({"inputs__ram__sections": {"out": OUT, "rest": {"type": "dwell"}}}, "ends the turn 0.01 away from where"),
    ({"inputs": {"arm": {"type": "crank", "pivot": "O", "sections": TOO_FAR}}}, "returns exceed the rises by 60 deg"),
    ({"inputs": {"arm": {"type": "crank", "pivot": "O"}}}, "never moves: give a ratio, a speed, harmonics"),
)


test_misplaced_second_inputs__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(JOINED, **changes))),
    ({"inputs__ram__guide": "rail"}, "inputs.ram.guide: 'rail' is not a guide"),
    ({"inputs__table": INDEX["inputs"]["table"] | {"pivot": "O"}}, "inputs.table.sections: 'table' makes 0.25 turns"),
    ({"guides__way__link": "left"}, "inputs.ram.guide: 'way' is on a link that this input drives"),
    ({"inputs__fore": {"type": "crank", "pivot": "B", "ratio": 1}}, "inputs.fore.pivot: 'B' is a joint of two links"),
    ({"input__start": 0.0, "input__stop": 1.0, "flywheel": {"inertia": 1.0}}, "flywheel"),
)


SLIDER = {"type": "slider", "link": "crank", "guide": "way", "point": "A", "start": 0, "stop": 0.05, "speed": 0.1}


test_wrong_second_cranks__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(FIVE_BAR, **changes))),
    ({"inputs__second__pivot": "B"}, "inputs.second.pivot: 'B' is on a link that this input drives"),
    ({"inputs__second__ratio": 0.5}, "makes 0.5 turns in a cycle of 1 of the crank"),
    ({"inputs": {"left": {"type": "crank", "pivot": "C", "ratio": 1}}}, "link 'left' is already moved by inputs.left"),
    ({"input": SLIDER, "guides": {"way": {}}}, "inputs.second: the first input slides and has no angle"),
    ({"regimes": {"idle": {"type": "steady"}}}, "regimes.idle: needs a single drive"),
    ({"flywheel": {"speed_fluctuation": 0.05}}, "flywheel: needs a single drive, but 'second' has its own"),
)


def test_turns_of_a_second_input__are_the_same_for_all_variants():
    with pytest.raises(AskError, match=r"inputs\.fore\.ratio"):
        Machine(Scene.model_validate(TWO_LINKS), varied=["inputs.fore.ratio"])
    with pytest.raises(AskError, match=r"inputs\.table\.sections\.on\.swing: its turns in a cycle"):
        Machine(
            Scene.model_validate(INDEX), varied=["inputs.table.sections.on.angle", "inputs.table.sections.on.swing"]
        )
