"""A machine driven through an elastic shaft: against integration in time, closed forms, the rigid limit."""

import math
from time import perf_counter

import numpy as np
import pytest
from each_case import refusals
from element_samples import one
from machines import crank, frame, rpp
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from engine import Machine, Scene, Verdict, drive_cycle, drive_run, seconds_of_runs
from sweeps.pictures.elements.elastic_sheets import machine_drive_sheet, machine_run_sheet
from sweeps.pictures.picture_error import PictureError
from sweeps.run.cost import on_shafts_text
from sweeps.study.study_reader import read_study
from sweeps.text.scene_text import write_scene

MASS, WHEEL, DRAG = 8.0, 0.05, 200.0
STALL, NO_LOAD = 100.0, 22.0
# A resistance that grows with the speed to its peak, as 1 − exp(−ω/ω₀).
PEAK, GROWTH = 15.0, 8.0
MOTOR = {"type": "dc_motor", "on": "crank", "stall_moment": STALL, "no_load_speed": NO_LOAD}
# Of all actions only some act in each test, so that scenes share what is compiled.
MOMENTS = {
    "motor": MOTOR,
    "brake": {"type": "against_motion", "on": "crank", "moment": 30.0},
    "push": {"type": "constant", "on": "crank", "moment": -20.0},
    "fan": {"type": "quadratic_drag", "on": "crank", "coefficient": 0.01},
    "bluff": {
        "type": "formula",
        "on": "crank",
        "moment": "-peak * (1 - exp(-omega / growth))",
        "numbers": {"peak": f"{PEAK} N m", "growth": f"{GROWTH} rad/s"},
    },
}
FORCES = {
    "load": {"type": "linear_drag", "on": "P", "coefficient": DRAG},
    "hold": {"type": "constant", "on": "P", "angle": 0.0, "force": 2000.0, "acts": "against"},
}


def only(*acting: str) -> dict:
    return {"off": [name for name in (*MOMENTS, *FORCES) if name not in acting]}


GENTLE = 400.0, 0.4, 0.2
DRIVE = {"type": "machine_drive", "stiffness": GENTLE[0], "damping": GENTLE[1], "motor_inertia": GENTLE[2]}
DRIVE |= only("motor", "load")


def yoke(drive: dict = {}, speed: float = 20.0, **parts: dict) -> Scene:  # noqa: B006
    """A Scotch yoke of I = WHEEL + m r² sin² φ and M = −c r² ω sin² φ."""
    return Scene.model_validate(
        {
            "points": {"O": frame(0.0, 0.0)},
            "guides": {"way": {}},
            "input": crank(length=0.1) | {"speed": speed},
            "groups": {"g": rpp(("block", "A"), ("yoke", "way"), math.pi / 2)},
            "bodies": {"yoke_body": {"link": "yoke", "mass": MASS}},
            "forces": FORCES,
            "shafts": {"wheel": {"geared_to": "crank", "ratio": 1.0, "inertia": WHEEL}},
            "moments": MOMENTS,
            "elements": {"d": DRIVE | drive},
        }
        | parts
        | {"points": {"O": frame(0.0, 0.0), "P": {"link": "yoke", "x": 0.0, "y": 0.0}}}
    )


# Asked together, so that scenes of one structure share what is compiled.
STEADY = [
    *("period", "greatest_moment", "least_moment", "mean_moment", "position_error", "motor_fluctuation"),
    *("machine_fluctuation", "multiplier", "second_multiplier", "third_multiplier", "power_residual"),
    *("alternating_moment", "motor_power", "damping_power", "dynamic_factor", "mean_speed", "growth_rate"),
    "rigid_moment",
]


def asked(scene: Scene, names: list[str] = STEADY, **varied: list) -> tuple[np.ndarray, dict, dict]:
    """Status, values and error estimates by the last parts of their names; double underscores stand for dots."""
    paths = {key.replace("__", "."): values for key, values in varied.items()}
    return answers(Machine(scene, [f"d.{name}" for name in names], varied=paths), *paths.values())


def answers(machine: Machine, *rows: list) -> tuple[np.ndarray, dict, dict]:
    outcome = machine.evaluate({path: np.array(row, float) for path, row in zip(machine.varied, rows, strict=True)})
    parts = outcome.summaries, outcome.errors
    return outcome.status, *({n.partition(".")[2]: v for n, v in part.items()} for part in parts)


# Another method: the equations in time, with φ₁ and φ₂ as unknowns, by DOP853 with dense output and its variational
# equations.


def equations(k: float, b: float, first: float, peak: float = 0.0):
    def inertia(phi):
        s = MASS * 0.01
        return WHEEL + s * np.sin(phi) ** 2, s * np.sin(2 * phi), 2 * s * np.cos(2 * phi)

    def rates(_, y):
        q, w1, phi, w2 = y[:4]
        whole, slope, bend = inertia(phi)
        moment = k * q + b * (w1 - w2)
        drag = DRAG * 0.01 * np.sin(phi) ** 2
        load = -drag * w2 - peak * (1.0 - np.exp(-w2 / GROWTH))
        by_speed = -drag - peak * np.exp(-w2 / GROWTH) / GROWTH
        a2 = (moment + load - 0.5 * slope * w2**2) / whole
        own = [w1 - w2, (STALL * (1 - w1 / NO_LOAD) - moment) / first, w2, a2]
        if len(y) == 4:
            return own
        by_phi = (-DRAG * 0.01 * np.sin(2 * phi) * w2 - 0.5 * bend * w2**2 - a2 * slope) / whole
        jacobian = np.array(
            [
                [0, 1, 0, -1],
                [-k / first, -(STALL / NO_LOAD + b) / first, 0, b / first],
                [0, 0, 0, 1],
                [k / whole, b / whole, by_phi, (-b + by_speed - slope * w2) / whole],
            ]
        )
        return np.concatenate([own, (jacobian @ y[4:].reshape(4, 4)).ravel()])

    return rates


def shot(k: float, b: float, first: float, peak: float = 0.0) -> dict:
    """Steady motion by shooting over the time of a turn."""
    rates = equations(k, b, first, peak)

    def flow(x, *variations):
        begin = [x[0], x[1], 0.0, x[2], *variations]
        return solve_ivp(rates, (0.0, x[3]), begin, method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True)

    def miss(x):
        end = flow(x).y[:, -1]
        return [1e2 * (end[0] - x[0]), end[1] - x[1], end[2] - math.tau, end[3] - x[2]]

    x = fsolve(miss, [0.02, 21.0, 21.0, math.tau / 21.0], xtol=1e-12)
    found = flow(x, *np.eye(4).ravel())
    q, w1, _, w2 = found.sol(np.linspace(0.0, x[3], 40_001))[:4]
    moment = k * q + b * (w1 - w2)
    multipliers = np.sort(np.abs(np.linalg.eigvals(found.y[4:, -1].reshape(4, 4))))[::-1]
    return {
        "period": x[3],
        "greatest_moment": moment.max(),
        "least_moment": moment.min(),
        "mean_moment": np.trapezoid(moment, dx=x[3] / 40_000) / x[3],
        "position_error": np.ptp(q) / 2,
        "motor_fluctuation": 2 * np.ptp(w1) / (w1.max() + w1.min()),
        "machine_fluctuation": 2 * np.ptp(w2) / (w2.max() + w2.min()),
        "multipliers": multipliers,
    }


@pytest.fixture(scope="module")
def machine() -> Machine:
    paths = [f"elements.d.{key}" for key in ("stiffness", "damping", "motor_inertia")]
    return Machine(yoke(), [f"d.{name}" for name in STEADY], varied=paths)


@pytest.mark.parametrize(("drive", "peak"), [((150.0, 1.0, 0.05), 0.0), ((5000.0, 0.1, 0.5), 0.0), (GENTLE, PEAK)])
def test_steady_motion__is_that_of_shooting_in_time(machine, drive, peak):
    resisted = yoke(only("motor", "load", "bluff"))
    status, values, errors = asked(resisted) if peak else answers(machine, *([x] for x in drive))
    assert status[0] == Verdict.OK
    expected = shot(*drive, peak)
    for name, value in expected.items():
        if name == "multipliers":
            continue
        # The integration is sure to 1e-9 or so; of 40 000 samples the highest misses a top by 1e-8 of the swing.
        assert values[name][0] == pytest.approx(value, rel=1e-7, abs=errors[name][0]), name
    # One multiplier in time is that of a shift along the motion: 1. The others are those of Poincaré's map.
    others = np.delete(expected["multipliers"], np.abs(expected["multipliers"] - 1.0).argmin())
    found = [values[f"{which}multiplier"][0] for which in ("", "second_", "third_")]
    np.testing.assert_allclose(found, others, rtol=1e-6, atol=1e-9)


def test_power__is_balanced_over_the_cycle_and_error_figures_hold(machine):
    rng = np.random.default_rng(5)
    numbers = [10.0 ** rng.uniform(*ends, 12) for ends in ((2.0, 7.0), (-3.0, 0.5), (-2.0, 1.0))]
    status, values, errors = answers(machine, *numbers)
    found = status == Verdict.OK
    assert found.mean() > 0.5
    assert set(status[~found]) <= {Verdict.TURNS_BACK, Verdict.GROWS, Verdict.STALLS, Verdict.NOT_FINITE}
    # Collocation at Gauss' points keeps quadratic sums of the state: what is left is rounding, more of stiffer shafts.
    assert (np.abs(values["power_residual"][found]) <= errors["power_residual"][found]).all()
    assert (errors["power_residual"][found] < 1e-11).all()
    assert (values["motor_power"][found] > values["damping_power"][found]).all()
    assert (values["damping_power"][found] >= 0.0).all()
    # Variants don't depend on their neighbours.
    chosen = [7, 2, 4]
    _, some, _ = answers(machine, *(row[chosen] for row in numbers))
    for name, row in values.items():
        np.testing.assert_array_equal(row[chosen], some[name], err_msg=name)
        assert np.isfinite(errors[name][found]).all(), name


def test_stiff_shaft__moves_as_the_rigid_regime_does(machine):
    work = {"type": "steady", **only("motor", "load")}
    rigid = yoke(regimes={"work": work}, flywheel={"inertia": 0.2, "speed_fluctuation": 0.1}, elements={})
    names = ["work.period", "work.speed_fluctuation", "work.motor_power", "work.multiplier"]
    expected = Machine(rigid, names).evaluate({}).summaries
    status, values, errors = answers(machine, [1e7, 1e9, 1e12], [0.4] * 3, [0.2] * 3)
    assert (status == Verdict.OK).all()
    # Moments of about 100 N·m twist the shaft by 1e-5, 1e-7, 1e-10; their change over a turn speeds by as much.
    tolerances = np.array([1e-4, 1e-6, 1e-8])
    for k, tolerance in enumerate(tolerances):
        assert values["period"][k] == pytest.approx(expected["work.period"][0], rel=tolerance)
        for name in ("machine_fluctuation", "motor_fluctuation"):
            assert values[name][k] == pytest.approx(expected["work.speed_fluctuation"][0], rel=tolerance), name
        assert values["motor_power"][k] == pytest.approx(expected["work.motor_power"][0], rel=tolerance)
        assert values["dynamic_factor"][k] == pytest.approx(1.0, abs=10 * tolerance)
    # The damping alone decides how fast the vibrations of a stiff shaft decay, whether the steps resolve them or not.
    for name in ("multiplier", "second_multiplier", "third_multiplier"):
        assert (np.abs(values[name] - values[name][0]) <= errors[name] + 1e-3).all()


WITH_ROTOR = {
    "wheel": {"geared_to": "crank", "ratio": 1.0, "inertia": WHEEL},
    "rotor": {"geared_to": "crank", "ratio": -4.0, "inertia": 0.2 / 16},
}


@pytest.mark.parametrize(
    "same",
    [yoke(speed=-20.0), yoke(shafts=WITH_ROTOR, elements={"d": DRIVE | {"motor_inertia": None, "driver": "rotor"}})],
    ids=["turning backwards", "rotor of the scene, reduced to the crank"],
)
def test_mirror_image_and_driver_of_the_scene__move_alike(machine, same):
    _, expected, _ = answers(machine, [DRIVE["stiffness"]], [DRIVE["damping"]], [DRIVE["motor_inertia"]])
    status, values, _ = asked(same)
    assert status[0] == Verdict.OK
    for name in ("greatest_moment", "machine_fluctuation", "multiplier"):
        # Two ways to the same inertia round differently, and so do the first guesses.
        assert values[name][0] == pytest.approx(expected[name][0], rel=1e-11), name


# Closed forms


def test_constant_inertia__vibrates_as_two_linear_masses():
    first, second, k, b, mean, swing = 0.2, 0.5, 3000.0, 0.8, 20.0, 1e-4
    fall = STALL / NO_LOAD
    scene = yoke(
        bodies={},
        forces={},
        shafts={"wheel": {"geared_to": "crank", "ratio": 1.0, "inertia": second}},
        moments={
            "motor": MOTOR,
            "load": {
                "type": "formula",
                "on": "crank",
                "moment": "-m - a * cos(3 * phi)",
                "numbers": {"m": f"{fall * (NO_LOAD - mean)!r} N m", "a": f"{swing} N m"},
            },
        },
        elements={"d": DRIVE | {"motor_inertia": first, "stiffness": k, "damping": b, "off": []}},
    )
    status, values, _ = asked(scene)
    assert status[0] == Verdict.OK
    w = 3 * mean
    coupled = k + 1j * w * b
    matrix = np.array([[coupled + 1j * w * fall - first * w**2, -coupled], [-coupled, coupled - second * w**2]])
    angles = np.linalg.solve(matrix, [0.0, -swing])
    # Linear in the swing up to its square: 1e-4 N·m against 9 N·m.
    assert values["mean_speed"][0] == pytest.approx(mean, rel=1e-8)
    assert values["mean_moment"][0] == pytest.approx(fall * (NO_LOAD - mean), rel=1e-7)
    assert values["alternating_moment"][0] == pytest.approx(abs(coupled * (angles[0] - angles[1])), rel=1e-4)
    # Eigenvalues of the two masses with their motor; the zero of a turn of the whole drops out.
    state = np.array([[0, 1, -1], [-k / first, -(fall + b) / first, b / first], [k / second, b / second, -b / second]])
    assert values["growth_rate"][0] == pytest.approx(np.linalg.eigvals(state).real.max(), rel=1e-4)


def parametric(shares: np.ndarray, ratio: float, swing: float) -> tuple[np.ndarray, dict, float]:
    """A yoke with I = I₀(1 − ε cos 2φ) on a shaft from a motor that nothing slows, at shares of 2Ω/(2ω_n)."""
    mass, size = 2.0 * swing / 0.01, 1.0
    omega = 20.0
    stiffness = size * (omega / shares) ** 2
    scene = yoke(
        {"motor_inertia": 1e6, "damping": None, "damping_ratio": ratio, **only("motor")},
        bodies={"yoke_body": {"link": "yoke", "mass": mass}},
        shafts={"wheel": {"geared_to": "crank", "ratio": 1.0, "inertia": size - swing}},
        moments=MOMENTS | {"motor": MOTOR | {"stall_moment": 1e9, "no_load_speed": omega}},
    )
    return *asked(scene, elements__d__stiffness=list(stiffness))[:2], omega


def test_parametric_tongue__has_its_width_and_growth():
    swing = 0.02
    shares = 1.0 + swing / 4 * np.array([-1.3, -0.7, 0.0, 0.7, 1.3])
    status, values, omega = parametric(shares, 0.0, swing)
    assert values["mean_speed"] == pytest.approx(omega, rel=1e-6)
    assert list(status == Verdict.GROWS) == [False, True, True, True, False]
    # To first order in ε: εω_n/4 at its middle, by the root of 1 − detuning² beside it.
    growth = swing * omega / 4
    assert values["growth_rate"][2] == pytest.approx(growth, rel=2 * swing)
    assert values["growth_rate"][[1, 3]] == pytest.approx(growth * math.sqrt(1 - 0.7**2), rel=0.15)
    # Outside of it a disturbance neither grows nor fades, but for what 1e6 kg·m² take.
    assert values["multiplier"][[0, 4]] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize(("share", "grows"), [(0.6, True), (1.4, False)])
def test_damping__stops_parametric_vibration_from_a_quarter_of_the_swing_on(share, grows):
    swing = 0.02
    status, values, omega = parametric(np.ones(1), share * swing / 4, swing)
    assert (status[0] == Verdict.GROWS) == grows
    assert values["growth_rate"][0] == pytest.approx((1 - share) * swing * omega / 4, rel=5 * swing)


# What can't be


SOFT = {"motor_inertia": 5.0, "stiffness": 200.0, **only("motor", "hold")}


def test_load_too_great_for_a_soft_shaft__turns_back():
    status, values, _ = asked(yoke(SOFT | {"damping": 0.05}), elements__d__stiffness=[200.0, 1e6])
    assert list(status) == [Verdict.TURNS_BACK, Verdict.OK]
    assert np.isnan(values["multiplier"][0])


def test_shafts_too_soft__turn_back_also_where_the_search_ends_in_singular_equations():
    # Searches that diverge reach 1e100, where rows of equations are equal to rounding.
    status, _, _ = asked(yoke(SOFT), elements__d__stiffness=np.linspace(50.0, 500.0, 16))
    assert set(status) == {Verdict.TURNS_BACK}


@pytest.mark.parametrize("driver", [{}, {"motor_inertia": None, "driver": "wheel"}])
def test_machine_without_inertia_at_dead_centres__says_so(driver):
    shafts = {"shafts": {"wheel": {"geared_to": "crank", "ratio": 1.0, "inertia": 0.5}}} if driver else {"shafts": {}}
    status, _, _ = asked(yoke(driver, **shafts))
    assert status[0] == Verdict.NO_INERTIA


def test_motor_too_weak_for_the_load__stalls():
    weak, load = {"motor": MOTOR | {"stall_moment": 0.5}}, {"hold": FORCES["hold"] | {"force": 200.0}}
    status, values, _ = asked(yoke(only("motor", "hold"), moments=MOMENTS | weak, forces=FORCES | load))
    assert status[0] == Verdict.STALLS
    assert np.isnan(values["greatest_moment"][0])


test_drive_that_is_given_twice_or_not_at_all__says_what_to_mend = refusals(
    lambda drive, parts: yoke(drive, **parts),
    ({"driver": "wheel"}, {}, "give driver or motor_inertia, one of the two"),
    ({"stiffness": None}, {}, "give stiffness or parts"),
    ({"damping_ratio": 0.1}, {}, "damping and damping_ratio are given"),
    ({"run": {"begin": "steady", "time": 1.0, "angle": 0.5}}, {}, "angle goes with begin = 'at rest'"),
    ({}, {"input": crank(start=0.0, stop=1.0)}, "can only drive a crank that turns fully"),
)


FADING = {"type": "formula", "on": "P", "force": "-f * t / 1 s", "numbers": {"f": "10 N"}}


test_drive_of_a_machine_that_cannot_be__says_what_to_mend = refusals(
    lambda drive, parts: Machine(yoke(drive, **parts), ["d.period"]),
    ({}, {"forces": FORCES | {"f": FADING}}, "'f' depends on time"),
    ({"off": []}, {"moments": {}}, "no motor drives it"),
    ({"off": ["motor"]}, {}, "every motor is off"),
    ({"off": ["moter"]}, {}, "did you mean 'motor'"),
    ({"motor_inertia": None, "driver": "weel"}, {}, "'weel' is not a link of this scene; … 'wheel'"),
    ({}, {"friction": {"f": {"pair": "g.second", "coefficient": 0.1}}}, "aren't computed on an elastic shaft"),
)


# Pictures


def test_picture__draws_the_summaries_and_refuses_what_has_no_motion():
    scene = yoke()
    cycle = drive_cycle(scene, "d")
    _, values, _ = asked(scene)
    # Of ends of 128 steps the highest may miss a top of a wave of an eighth turn by 1/2 (2π 8/256)², 2 % of it.
    assert cycle.moment.max() == pytest.approx(values["greatest_moment"][0], rel=1e-2)
    speed = cycle.machine_speed
    assert 2 * np.ptp(speed) / (speed.max() + speed.min()) == pytest.approx(values["machine_fluctuation"][0], rel=1e-2)
    figure = machine_drive_sheet(scene, "d", "yoke")
    assert [ax.get_title() for ax in figure.axes] == ["Shaft torque", "Crank speed", "Twist (crank lag)"]
    assert [ax.get_ylabel() for ax in figure.axes] == ["M, N·m", "ω, rpm", "Δφ, °"]
    with pytest.raises(PictureError, match=r"elements\.d: no steady motion"):
        machine_drive_sheet(yoke(SOFT), "d")


# Runs over time

RUN = only("motor", "load")
RUN_NAMES = ["run_greatest_moment", "run_greatest_at", "run_motor_speed", "run_machine_speed", "run_angle", "run_stops"]


def run_of(scene: Scene) -> tuple[dict, dict]:
    status, values, errors = asked(scene, RUN_NAMES)
    assert status[0] == Verdict.OK
    return tuple({name.removeprefix("run_"): float(row[0]) for name, row in part.items()} for part in (values, errors))


@pytest.mark.parametrize("peak", [0.0, PEAK])
def test_start_of_a_mechanism__is_that_of_integration_in_time(peak):
    (k, b, first), time = GENTLE, 0.5
    acting = only("motor", "load", "bluff") if peak else RUN
    found, errors = run_of(yoke({"run": acting | {"time": time}}))
    begin = np.concatenate([np.zeros(4), np.eye(4).ravel()])
    other = solve_ivp(
        equations(k, b, first, peak), (0.0, time), begin, method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True
    )
    q, w1, phi, w2 = other.sol(np.linspace(0.0, time, 100_001))[:4]
    moment = np.abs(k * q + b * (w1 - w2))
    # Of 100 001 samples the highest misses the top by 1e-8 of it; a cubic within steps of 0.3 rad by 2e-5.
    assert found["greatest_moment"] == pytest.approx(moment.max(), abs=errors["greatest_moment"] + 1e-7 * moment.max())
    assert errors["greatest_moment"] < 1e-3 * moment.max()
    for name, value in (("motor_speed", w1[-1]), ("machine_speed", w2[-1]), ("angle", phi[-1])):
        assert found[name] == pytest.approx(value, rel=1e-8), name
    assert found["stops"] == 0


def test_shaft_too_stiff_for_its_run__is_told_at_once():
    # 1 s at 4e6 rad/s: steps of 0.3 rad would take hours.
    names = [*RUN_NAMES, "natural_frequency"]
    status, values, _ = asked(yoke({"stiffness": 1e12, "run": RUN | {"time": 1.0}}), names)
    assert status[0] == Verdict.SHAFT_RIGID
    assert values["natural_frequency"][0] == pytest.approx(4.01e6, rel=1e-3)
    assert all(np.isnan(values[name][0]) for name in RUN_NAMES)


def test_run_out_of_steady_motion__goes_on_in_it():
    scene = yoke({"run": RUN | {"begin": "steady", "time": 1.0}})
    _, values, _ = asked(scene)
    cycles = 3
    scene = yoke({"run": RUN | {"begin": "steady", "time": cycles * values["period"][0]}})
    found, errors = run_of(scene)
    assert found["angle"] == pytest.approx(cycles * math.tau, rel=1e-7)
    greatest = values["greatest_moment"][0]
    assert found["greatest_moment"] == pytest.approx(greatest, abs=errors["greatest_moment"] + 1e-7 * greatest)


def test_stop_with_dry_friction__ends_at_rest_with_a_twist_that_it_holds():
    scene = yoke({"run": {"begin": "steady", "time": 1.5, **only("brake", "load")}})
    history = drive_run(scene, "d")
    found, _ = run_of(scene)
    assert found["stops"] >= 1
    assert found["machine_speed"] == 0.0
    # At rest the shaft goes on swinging with the motors' end, held by less than the brake's moment.
    assert abs(history.moment[-1]) < 30.0
    # What the motion had is gone: into the brake, the drag of the yoke and the damping, never less than nothing.
    yoke_inertia = WHEEL + MASS * 0.01 * np.sin(history.angle) ** 2
    energy = 0.1 * history.motor_speed**2 + 0.5 * yoke_inertia * history.machine_speed**2 + 200.0 * history.twist**2
    assert (np.diff(energy) <= 1e-7 * energy[0]).all()
    figure = machine_run_sheet(scene, "d", "stop")
    assert figure.axes[2].get_xlim() == (0.0, 1.5)


# Backlash


@pytest.mark.parametrize(
    ("damping", "load", "gap"), [(0.0, 25.0, 0.03), (1.5, 25.0, 0.03), (6.0, 0.0, 0.0), (0.0, 45.0, 0.03)]
)
def test_start__is_that_of_two_masses_phase_by_phase(damping, load, gap):
    """Impacts, parting and meeting again, the load held and let go: exact phases, with a constant moment."""
    first, second, k, moment, time = 0.2, 0.5, 3000.0, 40.0, 0.35
    parts = {
        "bodies": {"yoke_body": {"link": "yoke", "mass": 0.0}},
        "shafts": {"wheel": {"geared_to": "crank", "ratio": 1.0, "inertia": second}},
        "moments": MOMENTS
        | {
            "motor": MOTOR | {"stall_moment": moment, "no_load_speed": 1e4},
            "brake": MOMENTS["brake"] | {"moment": load},
        },
    }
    drive = {"motor_inertia": first, "stiffness": k, "damping": damping}
    drive |= only("motor", "fan", *(["brake"] if load <= moment else []))
    drive["run"] = {"time": time, "backlash": gap, **only("motor", "brake")}
    names = [*RUN_NAMES, "run_closings"]
    status, values, errors = asked(yoke(drive, **parts), names, moments__motor__no_load_speed=[1e4, 1e5])
    assert (status == Verdict.OK).all()
    found = {name.removeprefix("run_"): (10 * row[1] - row[0]) / 9 for name, row in values.items()}
    two = {"motor_inertia": first, "load_inertia": second, "stiffness": k, "damping": damping, "time": time}
    two |= {"type": "two_mass_drive", "motor_moment": moment, "load_moment": load, "backlash": gap}
    names = ["greatest_moment", "greatest_moment_at", "motor_speed", "load_speed", "closings"]
    same = ("greatest_moment", "greatest_at", "motor_speed", "machine_speed", "closings")
    for name, wanted in zip(same, one(two, *names), strict=True):
        # What is left of the fall is of order (8/1e4)², more of it after some impacts.
        assert found[name] == pytest.approx(wanted, rel=1e-4 if name.endswith("_at") else 2e-5), name
        assert errors[f"run_{name}"][1] <= 1e-3 * abs(found[name]) + 1e-6, name


# At φ = 0 the shaft of the first is ahead while its damper pulls back, that of the second the other way round.
@pytest.mark.parametrize(("stiffness", "damping"), [(400.0, 8.0), (1000.0, 3.0)])
def test_run_out_of_steady_motion_with_backlash__begins_without_pulling_at_teeth(stiffness, damping):
    run = {"begin": "steady", "time": 0.3, "backlash": 0.05, **only("load")}
    history = drive_run(yoke({"run": run, "stiffness": stiffness, "damping": damping}), "d")
    forward = history.twist > -0.025
    assert (np.where(forward, history.moment, -history.moment) >= -1e-9).all()


def test_run_on_a_stiff_shaft__takes_about_as_long_as_forecast(tmp_path, monkeypatch):
    scene = yoke({"stiffness": 4e5, "run": RUN | {"begin": "steady", "time": 0.3}})
    machine = Machine(scene, ["d.run_greatest_moment"], varied=["elements.d.stiffness"])
    stiffness = {"elements.d.stiffness": np.array([4e5])}
    # What is compiled first takes its time, too.
    machine.evaluate(stiffness)
    forecast, begun = seconds_of_runs(machine, stiffness), perf_counter()
    machine.evaluate(stiffness)
    took = perf_counter() - begun
    assert took / 5.0 < forecast < 5.0 * took
    assert seconds_of_runs(machine, {"elements.d.stiffness": np.array([1e12])}) == 0.0
    assert seconds_of_runs(Machine(scene, ["reduced_inertia.mean"]), {}) == 0.0
    (tmp_path / "scene.toml").write_text(write_scene(scene), encoding="utf8")
    study = read_study(tmp_path / "scene.toml")
    # However fast the machine.
    monkeypatch.setattr("sweeps.run.cost.LONG_ENOUGH", 0.0)
    assert on_shafts_text(study).startswith("Runs on elastic shafts: about ")


def test_start_through_backlash__loses_no_energy_but_to_drag_and_damper():
    """A yoke that starts through backlash: what the motor does less what drag and damper take is what moves."""
    run = RUN | {"time": 0.6, "backlash": 0.05}
    history = drive_run(yoke({"run": run, "damping": 0.0}), "d")
    inertia = WHEEL + MASS * 0.01 * np.sin(history.angle) ** 2
    stretch = np.where(history.twist > 0.0, history.twist, np.minimum(history.twist + 0.05, 0.0))
    energy = 0.1 * history.motor_speed**2 + 0.5 * inertia * history.machine_speed**2 + 200.0 * stretch**2
    motor = STALL * (1 - history.motor_speed / NO_LOAD) * history.motor_speed
    power = motor - DRAG * 0.01 * np.sin(history.angle) ** 2 * history.machine_speed**2
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(history.time))])
    # The trapezoid rule over steps of up to 0.3 rad of the vibration.
    assert energy == pytest.approx(work, abs=0.01 * energy.max())
    # In the gap the shaft bears nothing.
    inside = (history.twist < -1e-9) & (history.twist > -0.05 + 1e-9)
    assert inside.sum() > 5
    assert (history.moment[inside] == 0.0).all()
