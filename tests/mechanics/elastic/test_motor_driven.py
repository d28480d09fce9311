"""Two masses under a motor whose moment depends on its speed: other methods, exponentials, refusals."""

import math

import mpmath
import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from each_case import refusals
from element_samples import TWO_MASSES, element, figures, one, results

from engine import Verdict
from engine.elements.elastic_drives.two_masses import MOST_RADIANS

DRIVE = TWO_MASSES | {"time": 0.2}
LINE = {"type": "dc", "stall_moment": 100.0, "no_load_speed": 20.0}
KLOSS = {"type": "induction", "synchronous_speed": 20.0, "breakdown_moment": 150.0, "breakdown_slip": 0.3}
TABLE = {"type": "table", "speed": [0.0, 2.0, 5.0, 20.0], "moment": [80.0, 60.0, 140.0, 0.0]}
KEYS = ("motor_inertia", "load_inertia", "stiffness", "damping", "backlash", "load_moment")
NAMES = ("greatest_moment", "greatest_moment_at", "motor_speed", "load_speed", "closings")


def motor_moment(motor, w):
    if motor["type"] == "dc":
        return motor["stall_moment"] * (1 - w / motor["no_load_speed"])
    if motor["type"] == "table":
        x, y = np.array(motor["speed"]), np.array(motor["moment"])
        i = np.clip(np.searchsorted(x, w, side="right") - 1, 0, x.size - 2)
        return y[i] + (y[i + 1] - y[i]) / (x[i + 1] - x[i]) * (w - x[i])
    s = 1 - w / motor["synchronous_speed"]
    return 2 * motor["breakdown_moment"] / (s / motor["breakdown_slip"] + motor["breakdown_slip"] / s)


def phase_by_phase(n: dict, driving, twist: float, speed: float, until: float) -> tuple[np.ndarray, float, int]:
    """State at the end (twist, both speeds), greatest moment and closings, by SciPy from event to event."""
    first, second, k, b, gap, load = (n[key] for key in KEYS)

    def shaft(y, touch):
        return touch * touch * (k * (y[0] + (gap if touch < 0 else 0.0)) + b * (y[1] - y[2]))

    def rates(_, y, touch, way):
        moment = shaft(y, touch)
        return [y[1] - y[2], (driving(y[1]) - moment) / first, way * way * (moment - way * load) / second]

    def pressed(y, way):
        twist = y[0] if way > 0 else y[0] + gap
        return min(way * k * twist, way * (k * twist + b * (y[1] - y[2])))

    def guards(y, touch, way):
        touches = [touch * shaft(y, touch)] if touch else [-pressed(y, 1), -pressed(y, -1)]
        return [*(touches if gap > 0 else []), way * y[2] if way else load - abs(shaft(y, touch))]

    y, t, closings = np.array([twist, speed, speed]), 0.0, 0
    touch = 1 if gap == 0.0 or twist > 0.0 else 0 if twist >= -gap else -1
    way = 1 if speed > 0.0 or load == 0.0 else 0
    peak = abs(shaft(y, touch))
    while t < until:
        # Away from where the last event was.
        for end, more in ((min(t + 1e-8, until), {}), (until, {"max_step": 2e-3})):
            count = len(guards(y, touch, way))
            events = [lambda _, y, touch, way, i=i: guards(y, touch, way)[i] for i in range(count)] if more else None
            for event in events or []:
                event.terminal, event.direction = True, -1
            if t < end:
                gone = scipy.integrate.solve_ivp(
                    rates, (t, end), y, "DOP853", args=(touch, way), rtol=1e-11, atol=1e-13, events=events,
                    dense_output=True, **more,
                )  # fmt: skip
                seen = gone.sol(np.linspace(t, gone.t[-1], 4000))
                peak = max(peak, np.abs(shaft(seen, touch)).max())
                t, y = gone.t[-1], gone.y[:, -1]
        if gone.status == 1:
            fired = next(i for i, times in enumerate(gone.t_events) if times.size)
            if gap > 0.0 and fired < count - 1:
                closings += touch == 0
                touch = 0 if touch else (1 if y[0] > -0.5 * gap else -1)
            elif way:
                y[2], way = 0.0, 0
            moment = shaft(y, touch)
            peak = max(peak, abs(moment))
            # The load is at rest, and set off.
            if way == 0 and (abs(moment) > load or (fired == count - 1 and abs(moment) > load * (1 - 1e-9))):
                way = 1 if moment > 0 else -1
    return y, peak, closings


@pytest.mark.parametrize("begin", ["at rest", "running"])
@pytest.mark.parametrize("motor", [None, LINE, KLOSS, TABLE])
def test_drives__are_those_of_scipy_from_event_to_event(motor, begin):
    generator, n = np.random.default_rng(11), 6
    first, second = 10 ** generator.uniform(-1, 0.5, (2, n))
    k = 10 ** generator.uniform(3, 4.5, n)
    b = generator.uniform(0, 1, n) ** 3 * 3 * np.sqrt(k * first * second / (first + second))
    b[:2] = 0.0
    gap = np.where(generator.random(n) < 0.3, 0.0, generator.uniform(0.001, 0.05, n))
    numbers = dict(zip(KEYS, (first, second, k, b, gap, generator.uniform(4.0, 100.0, n)), strict=True))
    drive = DRIVE | {"damping": 0.0, "begin": begin, "time": 0.1}
    drive |= {"motor_moment": 80.0} if motor is None else {"motor": motor}
    driving = (lambda _: 80.0) if motor is None else lambda w: motor_moment(motor, w)
    if begin == "running":
        drive |= {"speed": 5.0, "load_before": 1.0}
        numbers |= {"speed": generator.uniform(1.0, 9.0, n), "load_before": generator.uniform(0, 200, n)}
    found = [value for value, _ in figures(drive, *NAMES, **numbers)]
    for v in range(n):
        own = {key: float(row[v]) for key, row in numbers.items()}
        twist, speed = -own["backlash"], 0.0
        if begin == "running":
            speed, (i1, i2) = own["speed"], (own["motor_inertia"], own["load_inertia"])
            twist = (driving(speed) * i2 + own["load_before"] * i1) / (i1 + i2) / own["stiffness"]
        y, peak, closings = phase_by_phase(own, driving, twist, speed, 0.1)
        greatest, _, motor_speed, load_speed, closed = (row[v] for row in found)
        swing = greatest / own["stiffness"] * math.sqrt(own["stiffness"] * (1 / first[v] + 1 / second[v]))
        # SciPy's kinks in a table, and looks at a phase 0.01 rad of its vibration apart.
        tolerance = 1e-6 if motor is TABLE else 1e-8
        assert (motor_speed, load_speed) == pytest.approx(tuple(y[1:]), abs=tolerance * (swing + speed))
        assert greatest == pytest.approx(peak, rel=1e-4)
        assert greatest >= peak * (1 - 1e-7)
        assert closed == closings


@pytest.mark.parametrize("motor", [LINE, TABLE, KLOSS])
def test_stiff_shaft__turns_as_a_rigid_one_in_the_end(motor):
    given = {"motor": motor, "backlash": 0.0, "load_moment": 10.0, "time": 2.0, "damping_ratio": 0.0}
    rigid = scipy.integrate.solve_ivp(
        lambda t, w: (motor_moment(motor, w[0]) - 10.0) / 3.5, (0, 2), [0], "DOP853", rtol=1e-12, max_step=1e-3
    )
    k, ratio = (grid.ravel() for grid in np.meshgrid([1e6], [0.0, 0.1, 1.5]))
    found = figures(DRIVE | given, "motor_speed", "load_speed", stiffness=k, damping_ratio=ratio)
    # Until T = 10 N m the load sticks, for at most 1 rad of the vibration; that turns the motor by T₀/(I₁ ω) more.
    away = 100.0 / np.sqrt(0.5 * k)
    assert all((np.abs(speeds - rigid.y[0, -1]) < 3 * away + 1e-9).all() for speeds, _ in found)


@pytest.mark.parametrize("motor", [LINE, TABLE, KLOSS])
def test_shaft_too_stiff_for_its_time__is_refused_with_its_natural_frequency(motor):
    drive = DRIVE | {"motor": motor, "backlash": 0.0, "load_moment": 0.0, "time": 1.0}
    inertia = 0.5 * 3.0 / 3.5
    stiffness = inertia * np.array([1e3, MOST_RADIANS * (1 + 1e-9), 1e9]) ** 2
    found, _, status = results(drive, "motor_speed", "rigid_moment", "natural_frequency", stiffness=stiffness)
    speed, rigid, frequency = found.values()
    assert status.tolist() == [Verdict.OK, Verdict.SHAFT_RIGID, Verdict.SHAFT_RIGID]
    assert np.isnan(speed).tolist() == [False, True, True]
    assert frequency == pytest.approx(np.sqrt(stiffness / inertia), rel=1e-14)
    assert rigid == pytest.approx([motor_moment(motor, 0.0) * 3.0 / 3.5] * 3, rel=1e-14)


def test_most_vibrations_that_are_followed__keep_their_error_estimates():
    """The stiffest vibrates by nearly as many radians as are followed at all."""
    k = np.array([1e4, 0.999 * MOST_RADIANS**2 * 0.5 * 3.0 / 3.5])
    drive = DRIVE | {"motor": LINE, "backlash": 0.0, "load_moment": 0.0, "time": 1.0}
    found = figures(drive, "motor_speed", "load_speed", stiffness=k)
    with mpmath.workdps(50):
        for i, stiffness in enumerate(map(mpmath.mpf, k)):
            moved = mpmath.matrix(
                [[0, 1, -1, 0], [-2 * stiffness, -10, 0, 200], [stiffness / 3, 0, 0, 0], [0, 0, 0, 0]]
            )
            rates, modes = mpmath.eig(moved)
            shares = mpmath.lu_solve(modes, mpmath.matrix([0, 0, 0, 1]))
            for row, (speeds, errors) in enumerate(found, 1):
                exact = sum(modes[row, k] * mpmath.exp(rates[k]) * shares[k] for k in range(4))
                assert abs(speeds[i] - exact) <= errors[i]


def test_drive_that_is_stalled__vibrates_about_its_moment_for_as_long_as_asked():
    drive = DRIVE | {"motor": LINE, "backlash": 0.0, "stiffness": 1e7, "load_moment": 500.0, "time": 1.0}
    (greatest, _), (at, _), (first, error), (second, _), _ = figures(drive, *NAMES)
    # I₁ e″ + (S) e′ + k e = M₀ with S = 5 N m s.
    decay, frequency = 5.0, math.sqrt(1e7 / 0.5 - 5.0**2)
    assert greatest == pytest.approx(100.0 * (1 + math.exp(-decay * math.pi / frequency)), rel=1e-12)
    assert at == pytest.approx(math.pi / frequency, rel=1e-9)
    end = 100.0 / (0.5 * frequency) * math.exp(-decay) * math.sin(frequency)
    assert abs(first - end) <= error
    assert second == 0.0


def test_nameplate__gives_the_motor_of_its_constants():
    nameplate = {"power": 2e3, "rated_speed": 18.0, "no_load_speed": 20.0}
    drive = DRIVE | {"motor": {"type": "dc"} | nameplate}
    given = {"type": "dc", "stall_moment": 2e3 / 18.0 * 10.0, "no_load_speed": 20.0}
    assert one(drive, *NAMES) == pytest.approx(one(DRIVE | {"motor": given}, *NAMES), rel=1e-12)


test_motor_that_cannot_be__says_what_to_mend = refusals(
    lambda change: element(DRIVE | change),
    ({}, "give motor_moment"),
    ({"motor": LINE, "motor_moment": 5.0}, "one of the two"),
    ({"motor": TABLE | {"speed": [0.0, 2.0, 2.0, 20.0]}}, "above the one before"),
    ({"motor": {"type": "table", "speed": [1.0], "moment": [5.0]}}, "at least 2"),
    ({"motor": {"type": "table", "speed": [1.0, 2.0], "moment": [5.0]}}, "moment"),
    ({"motor": {"type": "induction", "synchronous_speed": 150.0}}, "Kloss"),
)
