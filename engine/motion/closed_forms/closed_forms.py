"""Motion of a machine whose reduced moment of inertia is constant, in closed form.

I d(omega)/dt = M with M constant, falling with the speed or with its square;
`engine.motion.closed_forms.induction_run_up` has the induction motor. M is positive where it drives, negative where it
resists a positive speed; times and angles count from the beginning. Scalar functions: floats in, floats out, NaN where
a speed or angle is never reached. Where M varies, times and angles are quotients by the logarithmic mean (b -
a)/ln(b/a) of its values a and b at both ends, which stays accurate where they are equal.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (equation of motion, run-down).
"""

import math

from engine.compiling.decorators import scalar


@scalar
def constant_moment(inertia: float, moment: float, omega0: float, t: float) -> tuple[float, float]:
    """Speed and angle at time t under a constant moment: omega0 + M t/I and (omega0 + omega) t/2.

    Parameters
    ----------
    inertia, moment, omega0, t : float
        I [kg·m²], M [N·m], speed at the beginning [rad/s], time [s].

    Returns
    -------
    omega, phi : float
        [rad/s] and [rad].
    """
    gained = moment / inertia * t
    return omega0 + gained, (omega0 + gained / 2) * t


@scalar
def constant_moment_to_speed(inertia: float, moment: float, omega0: float, omega: float) -> tuple[float, float]:
    """Time and angle to a speed under a constant moment: I (omega - omega0)/M and I (omega² - omega0²)/(2 M).

    With omega = 0 they are the stop time and the stop angle of a brake.

    Parameters
    ----------
    inertia, moment, omega0, omega : float
        I [kg·m²], M [N·m], speeds at the beginning and the end [rad/s].

    Returns
    -------
    time, angle : float
        [s] and [rad]; NaN where the moment doesn't lead to the speed.
    """
    time = ahead(omega - omega0, inertia * (omega - omega0) / moment)
    return time, (omega0 + omega) / 2 * time


@scalar
def constant_moment_to_angle(inertia: float, moment: float, omega0: float, angle: float) -> tuple[float, float]:
    """Time until an angle is first turned under a constant moment, and the speed there.

    With omega² = omega0² + 2 M angle/I the time is 2 angle/(omega0 + omega), or I (omega - omega0)/M where the
    machine first moves away from the angle and is turned round: neither form cancels.

    Parameters
    ----------
    inertia, moment, omega0, angle : float
        I [kg·m²], M [N·m], speed at the beginning [rad/s], angle of either sign [rad].

    Returns
    -------
    time, omega : float
        [s] and [rad/s]; NaN where the machine stops or turns round before the angle.
    """
    if angle == 0.0:
        return 0.0, omega0
    epsilon = moment / inertia
    omega = math.copysign(math.sqrt(omega0 * omega0 + 2 * epsilon * angle), angle)
    time = 2 * angle / (omega0 + omega) if omega0 * angle >= 0.0 else (omega - omega0) / epsilon
    if 0.0 <= time < math.inf:
        return time, omega
    return math.nan, math.nan


@scalar
def linear_moment(inertia: float, m0: float, m1: float, omega0: float, t: float) -> tuple[float, float]:
    """Speed and angle at time t under M = m0 - m1 omega: a DC motor with constant and viscous load.

    With x = m1 t/I: omega = omega0 e^-x + (m0 t/I) (1 - e^-x)/x and
    phi = omega0 t (1 - e^-x)/x + (m0 t²/I) (e^-x - 1 + x)/x².

    Parameters
    ----------
    inertia, m0, m1, omega0, t : float
        I [kg·m²], m0 [N·m], m1 of either sign or 0 [N·m·s], speed at the beginning [rad/s], time [s].

    Returns
    -------
    omega, phi : float
        [rad/s] and [rad].
    """
    x = m1 * t / inertia
    once = over_argument(-math.expm1(-x), x)
    if abs(x) < 1.0:
        twice = 0.5
        # Terms beyond x^16/18! don't count.
        for k in range(18, 2, -1):
            twice = 0.5 - x / k * twice
    else:
        twice = (1.0 - once) / x
    gained = m0 * t / inertia
    return omega0 * math.exp(-x) + gained * once, (omega0 * once + gained * twice) * t


@scalar
def linear_moment_to_speed(inertia: float, m0: float, m1: float, omega0: float, omega: float) -> tuple[float, float]:
    """Time and angle to a speed under M = m0 - m1 omega: t = (I/m1) ln(M(omega0)/M(omega)).

    Parameters
    ----------
    inertia, m0, m1, omega0, omega : float
        I [kg·m²], m0 [N·m], m1 of either sign or 0 [N·m·s], speeds at the beginning and the end [rad/s].

    Returns
    -------
    time, angle : float
        [s] and [rad]; NaN where the speed is never reached, the final speed itself included.
    """
    rise = omega - omega0
    mean = logarithmic_mean(m0 - m1 * omega0, m0 - m1 * omega)
    time = ahead(rise, inertia * rise / mean)
    return time, linear_moment(inertia, m0, m1, omega0, time)[1]


@scalar
def linear_moment_squares(inertia: float, m0: float, m1: float, omega0: float, t: float) -> float:
    """Integral of omega² over time under M = m0 - m1 omega: the work of a viscous resistance over its coefficient.

    By the balance of energy (m0 phi - I (omega² - omega0²)/2)/m1; where x = m1 t/I is small, with the acceleration
    e at the beginning, t (omega0² + 2 omega0 e t f + (e t)² g) by the series of f = (e^-x - 1 + x)/x² and
    g = (x - 3/2 + 2 e^-x - e^-2x/2)/x³.

    Parameters
    ----------
    inertia, m0, m1, omega0, t : float
        I [kg·m²], m0 [N·m], m1 of either sign or 0 [N·m·s], speed at the beginning [rad/s], time [s].

    Returns
    -------
    float
        [rad²/s].
    """
    x = m1 * t / inertia
    if abs(x) >= 1.0:
        omega, phi = linear_moment(inertia, m0, m1, omega0, t)
        return (m0 * phi - inertia * (omega - omega0) * (omega + omega0) / 2) / m1
    f, g, term, power = 0.5, 0.0, 1 / 6, 4.0
    # Terms beyond 2^26 x^24/27! don't count.
    for n in range(4, 29):
        f -= x * term
        g += (power - 2) * term
        term *= -x / n
        power += power
    gained = (m0 - m1 * omega0) * t / inertia
    return t * (omega0 * omega0 + gained * (2 * omega0 * f + gained * g))


@scalar
def quadratic_moment(inertia: float, m0: float, m2: float, omega0: float, t: float) -> tuple[float, float]:
    """Speed and angle at time t under M = m0 - m2 omega²: a fan.

    With k = sqrt(m0 m2)/I and T = tanh(k t)/(k t): omega = (omega0 + m0 t T/I)/(1 + m2 omega0 t T/I) and
    phi = (I/m2) ln(cosh k t + m2 omega0 t sinh(k t)/(k t I)). T = 1 for m0 = 0, the run-down of a fan
    omega0/(1 + m2 omega0 t/I); for m0 < 0 circular functions take the place of the hyperbolic ones.

    Parameters
    ----------
    inertia, m0, m2, omega0, t : float
        I [kg·m²], m0 of either sign or 0 [N·m], m2 >= 0 [N·m·s²], speed at the beginning, >= 0 [rad/s], time [s].

    Returns
    -------
    omega, phi : float
        [rad/s] and [rad]; NaN from where the machine has come to rest, for there the fan's moment changes its sign.
    """
    kt = math.sqrt(abs(m0) * m2) / inertia * t
    gained = m0 * t / inertia
    lost = m2 * omega0 * t / inertia
    if m0 < 0.0:
        tangent, sine, half_sine = (
            over_argument(math.tan(kt), kt),
            over_argument(math.sin(kt), kt),
            over_argument(math.sin(kt / 2), kt / 2),
        )
    else:
        tangent, sine, half_sine = over_argument(math.tanh(kt), kt), 1.0, 1.0
    omega = (omega0 + gained * tangent) / (1.0 + lost * tangent)
    if not omega >= 0.0 or not omega0 >= 0.0 or (m0 < 0.0 and kt > math.pi / 2):
        return math.nan, math.nan
    if m0 > 0.0 and kt > 1.0:
        above = omega0 * math.sqrt(m2 / m0) - 1.0
        return omega, inertia / m2 * (kt + math.log1p(-above * math.expm1(-2 * kt) / 2))
    if m0 > 0.0:
        sine, half_sine = over_argument(math.sinh(kt), kt), over_argument(math.sinh(kt / 2), kt / 2)
    # cosh x - 1 = 2 sinh²(x/2), without cancellation.
    unbraked = (gained / 2 * half_sine * half_sine + omega0 * sine) * t
    growth = m2 / inertia * unbraked
    return omega, unbraked * over_argument(math.log1p(growth), growth)


@scalar
def quadratic_moment_to_speed(inertia: float, m0: float, m2: float, omega0: float, omega: float) -> tuple[float, float]:
    """Time and angle to a speed under M = m0 - m2 omega²: a fan.

    phi = (I/(2 m2)) ln(M(omega0)/M(omega)), the energy's form. With r = omega sqrt(m2/m0) the time is
    (1/(2 k)) ln((1 + r)(1 - r0)/((1 - r)(1 + r0))), k = sqrt(m0 m2)/I; for m0 < 0 a difference of arctangents.

    Parameters
    ----------
    inertia, m0, m2, omega0, omega : float
        I [kg·m²], m0 of either sign or 0 [N·m], m2 >= 0 [N·m·s²], speeds at the beginning and the end,
        >= 0 [rad/s].

    Returns
    -------
    time, angle : float
        [s] and [rad]; NaN where the speed is never reached, the final speed itself included.
    """
    rise = omega - omega0
    squares = rise * (omega + omega0)
    mean = logarithmic_mean(m0 - m2 * omega0 * omega0, m0 - m2 * omega * omega)
    angle = inertia * squares / mean / 2
    if m0 > 0.0:
        scale = math.sqrt(m2 / m0)
        r0, r = scale * omega0, scale * omega
        ends = logarithmic_mean((1.0 - r) * (1.0 + r0), (1.0 + r) * (1.0 - r0))
        time = inertia * rise / m0 / ends
    else:
        slowed = -rise / (m2 * omega * omega0 - m0)
        turned = math.sqrt(-m0 * m2) * slowed
        time = inertia * slowed * over_argument(math.atan(turned), turned)
    if not omega >= 0.0 or not omega0 >= 0.0:
        return math.nan, math.nan
    return ahead(rise, time), ahead(rise, angle)


@scalar
def logarithmic_mean(a: float, b: float) -> float:
    """(b - a)/ln(b/a), a where b = a; NaN unless both have one sign.

    Parameters
    ----------
    a, b : float
    """
    if not ((a > 0.0 and b > 0.0) or (a < 0.0 and b < 0.0)):
        return math.nan
    low, high = (a, b) if abs(a) < abs(b) else (b, a)
    growth = (high - low) / low
    return low / over_argument(math.log1p(growth), growth)


@scalar
def over_argument(f: float, x: float) -> float:
    """f(x)/x of a function that starts as x.

    Parameters
    ----------
    f, x : float
        f(x) and x.
    """
    return 1.0 if x == 0.0 else f / x


@scalar
def ahead(way: float, quantity: float) -> float:
    """A time or an angle on the way to a speed: 0 where there is no way to go, NaN where it isn't ahead.

    Parameters
    ----------
    way, quantity : float
        What is left to the speed, and the time or angle.
    """
    if way == 0.0:
        return 0.0
    return quantity if 0.0 < quantity < math.inf else math.nan
