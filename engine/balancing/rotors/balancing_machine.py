"""A balancing machine: a rigid rotor runs down through resonance on an elastic support that moves in one direction.

The rotor's axis moves across itself, x(z) = n(z)·q along the rotor: on two springs with q = (x_G, theta), n = (1, z -
z_G), or in a swinging frame with q = theta, n = z - z_C about the axis C of the swing. Unbalances U_k at z_k drive it
with

    M q'' + D q' + K q = Re[(omega² - i epsilon) Σ n(z_k) U_k exp(i phi)].

The support is stiff across the direction of motion, so gyroscopic moments only load it; what the vibration takes from
the speed is left out. The motor is off: I epsilon = -(m0 + m1 omega). Angles phi count from the rotor's mark; at
phi = 0 its x points in the direction of motion.

The machine reads what a filter in step with the rotor reads: the once-per-turn part V of x = Re[V exp(i phi)], as the
mean of 2 x exp(-i phi) over a few turns with a Hann window, which suppresses what V's own change leaks into it.

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (balancing on machines: the swinging frame); A.
Muszynska, Rotordynamics (synchronous response).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from engine.motion.closed_forms.closed_forms import linear_moment_to_speed

# Samples of x in a turn: the once-per-turn part is free of its multiples up to the 62nd.
PER_TURN = 64
# Turns in the window of a reading.
WINDOW = 6


class Support(NamedTuple):
    """An elastic support with its rotor.

    Attributes
    ----------
    mass, damping, stiffness : ndarray (n, n)
        M, D and K for the coordinates q.
    origin : float
        z_G or z_C [m].
    swings : bool
        Whether only theta is free.
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    origin: float
    swings: bool

    def shape(self, positions: ArrayLike) -> np.ndarray:
        """n(z), ndarray (..., n), at positions along the axis [m] (...)."""
        arms = np.asarray(positions, dtype=float) - self.origin
        return arms[..., None] if self.swings else np.stack([np.ones_like(arms), arms], axis=-1)


class RunDown(NamedTuple):
    """How the rotor slows down: from and to which speed [rad/s], I [kg·m²], m0 [N·m] and m1 [N·m·s]."""

    start: float
    stop: float
    inertia: float
    constant: float
    viscous: float = 0.0


class Readings(NamedTuple):
    """What the machine reads in a run-down.

    Attributes
    ----------
    speeds : ndarray (readings,)
        In the middle of the window, which moves on by a turn; falling [rad/s].
    vibrations : ndarray of complex (readings, sensors)
        Once-per-turn parts V [m].
    """

    speeds: np.ndarray
    vibrations: np.ndarray

    def at(self, speed: float) -> np.ndarray:
        """V at a speed [rad/s], between the readings beside it: ndarray of complex (sensors,)."""
        rising = self.vibrations[::-1]
        parts = [np.interp(speed, self.speeds[::-1], v, math.nan, math.nan) for v in rising.T]
        return np.array(parts)

    def peaks(self) -> np.ndarray:
        """The reading with the greatest amplitude of each sensor: ndarray of complex (sensors,)."""
        turns = np.abs(self.vibrations).argmax(axis=0)
        return self.vibrations[turns, np.arange(turns.size)]


def elastic_supports(
    mass: float, inertia: float, centre: float, positions: ArrayLike, stiffness: ArrayLike, damping: ArrayLike
) -> Support:
    """Rotor in bearings on springs and dampers.

    Parameters
    ----------
    mass, inertia, centre : float
        Of rotor and bearings: mass [kg], moment of inertia about an axis across the rotor's through the centre of
        mass [kg·m²], position of that [m].
    positions, stiffness, damping : array_like (supports,)
        [m], [N/m], [N·s/m].
    """
    arms = np.asarray(positions, dtype=float) - centre
    shapes = np.stack([np.ones_like(arms), arms], axis=-1)
    return Support(
        mass=np.diag([mass, inertia]),
        damping=shapes.T @ (np.asarray(damping, dtype=float)[:, None] * shapes),
        stiffness=shapes.T @ (np.asarray(stiffness, dtype=float)[:, None] * shapes),
        origin=float(centre),
        swings=False,
    )


def swinging_frame(inertia: float, axis: float, stiffness: float, damping: float) -> Support:
    """Rotor in a frame that swings about an axis across the rotor's.

    Parameters
    ----------
    inertia, axis : float
        Of frame and rotor about the axis of the swing [kg·m²]; its position along the rotor's axis z_C [m].
    stiffness, damping : float
        Against the angle [N·m/rad], [N·m·s/rad].
    """
    mass, damper, spring = (np.array([[float(value)]]) for value in (inertia, damping, stiffness))
    return Support(mass, damper, spring, float(axis), True)


def natural_frequencies(support: Support) -> np.ndarray:
    """Of the undamped rotor on its support, rising [rad/s] (n,)."""
    squares = np.linalg.eigvals(np.linalg.solve(support.mass, support.stiffness)).real
    return np.sqrt(np.sort(squares))


def steady_vibration(
    support: Support, omega: float, unbalances: ArrayLike, positions: ArrayLike, sensors: ArrayLike
) -> np.ndarray:
    """Vibration at a uniform speed, V = n(s)·(K - omega² M + i omega D)⁻¹ omega² Σ n(z_k) U_k.

    Parameters
    ----------
    support : Support
    omega : float
        [rad/s].
    unbalances : array_like of complex (unbalances,)
        [kg·m].
    positions, sensors : array_like (unbalances,), (sensors,)
        Along the axis [m].

    Returns
    -------
    ndarray of complex (sensors,)
        [m].
    """
    return support.shape(sensors) @ _steady(support, omega, _drive(support, unbalances, positions))


def run_down(
    support: Support, run: RunDown, unbalances: ArrayLike, positions: ArrayLike, sensors: ArrayLike, rtol: float = 1e-9
) -> Readings:
    """Readings of a run-down that begins in steady motion.

    Parameters
    ----------
    support : Support
    run : RunDown
    unbalances : array_like of complex (unbalances,)
        [kg·m].
    positions, sensors : array_like (unbalances,), (sensors,)
        Along the axis [m].
    rtol : float
        Relative tolerance of the integration over the angle (DOP853).

    Raises
    ------
    ValueError
        The moments don't bring the rotor from one speed to the other, or within fewer turns than a reading takes.
    """
    _, angle = linear_moment_to_speed(run.inertia, -run.constant, run.viscous, run.start, run.stop)
    turns = int(angle / math.tau) if run.start > run.stop > 0.0 and math.isfinite(angle) else 0
    if turns < WINDOW:
        raise ValueError(
            f"run-down from {run.start:g} to {run.stop:g} rad/s with m0 = {run.constant:g} N m, m1 = {run.viscous:g} "
            f"N m s doesn't take the {WINDOW} turns of a reading; the start must be faster than the stop, both above "
            "0, and the moments small enough for many turns"
        )
    drive = _drive(support, unbalances, positions)
    start = _steady(support, run.start, drive)
    state = np.concatenate([start.real, (1j * run.start * start).real, [run.start]])
    phi = math.tau / PER_TURN * np.arange(turns * PER_TURN)
    # The steady amplitude gives the size below which errors don't count; a balanced rotor stays at rest.
    floor = rtol * (np.abs(start).max() or 1.0)
    solution = solve_ivp(
        _motion(support, run, drive), (0.0, phi[-1]), state, method="DOP853", t_eval=phi, rtol=rtol,
        atol=np.concatenate([np.full(start.size, floor), np.full(start.size, floor * run.stop), [rtol * run.stop]]),
    )  # fmt: skip
    x = support.shape(sensors) @ solution.y[: start.size]
    span = WINDOW * PER_TURN
    window = 1 - np.cos(math.tau / span * (np.arange(span) + 0.5))
    vibrations = sliding_window_view(x, span, axis=1)[:, ::PER_TURN] @ (window * np.exp(-1j * phi[:span]) * (2 / span))
    return Readings(solution.y[-1, span // 2 :: PER_TURN][: turns - WINDOW + 1], vibrations.T)


def _drive(support: Support, unbalances: ArrayLike, positions: ArrayLike) -> np.ndarray:
    """Σ n(z_k) U_k, ndarray of complex (n,)."""
    return np.asarray(unbalances) @ support.shape(positions)


def _steady(support: Support, omega: float, drive: np.ndarray) -> np.ndarray:
    """Complex amplitudes of q at a uniform speed (n,)."""
    dynamic = support.stiffness - omega**2 * support.mass + 1j * omega * support.damping
    return np.linalg.solve(dynamic, omega**2 * drive)


def _motion(support: Support, run: RunDown, drive: np.ndarray) -> Callable[[float, np.ndarray], np.ndarray]:
    """Derivatives of (q, q', omega) by the angle phi."""
    n = drive.size
    inverse = np.linalg.inv(support.mass)
    spring, damper, push = inverse @ support.stiffness, inverse @ support.damping, inverse @ drive

    def derivatives(phi: float, state: np.ndarray) -> np.ndarray:
        q, rate, omega = state[:n], state[n : 2 * n], state[2 * n]
        epsilon = -(run.constant + run.viscous * omega) / run.inertia
        turned = complex(math.cos(phi), math.sin(phi)) * complex(omega * omega, -epsilon)
        acceleration = (turned * push).real - spring @ q - damper @ rate
        return np.concatenate([rate, acceleration, [epsilon]]) / omega

    return derivatives
