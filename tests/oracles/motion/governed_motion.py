"""Motion of Porter's governor with equal arms and its engine, by its angle, with events found by SciPy."""

import math

import numpy as np
from scipy.integrate import solve_ivp

STICKS, RISES, FALLS = 0, 1, -1


class GovernedMotion:
    """What a change of load does, in the angle of the arms; one regime after another.

    Kinetic energy ½ (2 m l² + 4 M l² sin² ψ) ψ̇² + ½ (I + i² 2 m l² sin² ψ) ω²; weights 2 m g l cos ψ + 2 M g l cos ψ;
    a spring holds the sleeve down.
    """

    def __init__(self, governor, gravity=9.80665):
        self.g, self.e, self.gravity = governor, governor["engine"], gravity
        self.m, self.big, self.arm = governor["ball_mass"], governor["sleeve_mass"], governor["upper_arm"]
        self.turning = 2 * self.m
        self.weight = self.gravity * 2 * (self.m + self.big)
        self.stiffness, self.preload = governor.get("stiffness", 0.0), governor.get("preload", 0.0)
        self.low, self.high = (math.asin(governor[f"{key}_radius"] / self.arm) for key in ("least", "greatest"))
        self.whole = self.lift(self.high)
        self.ratio, self.s = self.e.get("ratio", 1.0), self.e.get("self_regulation", 0.0)
        self.mean = (self.speed_at(self.low) + self.speed_at(self.high)) / 2
        self.friction, self.damping = governor.get("friction", 0.0), governor.get("damping", 0.0)
        self.open = True
        # Of a mechanism by its angle: inertia beside its mean, the derivative of that, driving moment over its mean,
        # other moments without their mean.
        self.curves = lambda phi: (0.0, 0.0, 1.0, 0.0)

    def lift(self, psi):
        return 2 * self.arm * (math.cos(self.low) - math.cos(psi))

    def held(self, psi):
        """Force on the angle of weights and spring, over l sin ψ."""
        return self.weight + 2 * (self.preload + self.stiffness * self.lift(psi))

    def speed_at(self, psi):
        return math.sqrt(self.held(psi) / (self.turning * self.arm * math.cos(psi)))

    def psi_of(self, lift):
        return math.acos(math.cos(self.low) - lift / (2 * self.arm))

    def moment(self, psi, omega, load, share=1.0):
        t = self.e["throttle"]
        full, closed = t["full"], t.get("closed", 0.0)
        if t["type"] == "linear":
            given = full - (full - closed) * self.lift(psi) / self.whole
        else:
            given = full if self.open else closed
        return given * share - self.s * (omega - self.mean / self.ratio) - load

    def steady(self, load):
        """Angle at which the engine carries a load."""
        t = self.e["throttle"]
        if t["type"] != "linear":
            return self.psi_of(t["switch"])
        low, high = self.low, self.high
        for _ in range(200):
            middle = (low + high) / 2
            if self.moment(middle, self.speed_at(middle) / self.ratio, load) > 0:
                low = middle
            else:
                high = middle
        return low

    def left(self, psi, omega):
        """Force on the angle that centrifugal forces leave of weights and spring."""
        out = self.turning * self.arm**2 * math.sin(psi) * math.cos(psi) * (self.ratio * omega) ** 2
        return out - self.held(psi) * self.arm * math.sin(psi)

    def rates(self, y, mode, load):
        psi, velocity, omega, phi = y
        change, slope, share, other = self.curves(phi)
        big, arm, i = self.big, self.arm, self.ratio
        sine, cosine = math.sin(psi), math.cos(psi)
        inertia = self.e["inertia"] + change + i * i * self.turning * arm * arm * sine**2
        moment = self.moment(psi, omega, load, share) + other - slope * omega**2 / 2
        if mode == STICKS:
            return [0.0, 0.0, moment / inertia, omega]
        rise = 2 * arm * sine
        force = self.left(psi, omega) - rise * (self.damping * rise * velocity + mode * self.friction)
        own = self.turning * arm * arm + 4 * big * arm * arm * sine**2
        turn = (force - 4 * big * arm * arm * sine * cosine * velocity**2) / own
        return [
            velocity,
            turn,
            (moment - i * i * 2 * self.turning * arm * arm * sine * cosine * velocity * omega) / inertia,
            omega,
        ]

    def follow(self, load, new_load, duration):
        """Regimes as dense solutions of their spans, all extremes of the speed, and how often each stop is hit."""
        psi = self.steady(load)
        y, t = [psi, 0.0, self.speed_at(psi) / self.ratio, 0.0], 0.0
        if self.e["throttle"]["type"] != "linear":
            # At 99 % of the balls' way from the inner stop to the switch.
            y[0] = math.asin(0.01 * math.sin(self.low) + 0.99 * math.sin(psi))
            y[2] = self.speed_at(y[0]) / self.ratio
        mode, hits = (STICKS if self.friction else RISES), [0, 0]
        regimes, speeds = [], [y[2]]
        while t < duration - 1e-12:
            found = self.regime(y, t, duration, mode, new_load)
            regimes.append(found.sol)
            y, t = list(found.y[:, -1]), found.t[-1]
            speeds += [y[2], *(state[2] for state in found.y_events[-1])]
            if found.status != 1:
                break
            mode = self.following(y, mode, [len(e) > 0 for e in found.t_events], hits)
        return regimes, np.array(speeds), hits

    def regime(self, y, t, duration, mode, load):
        slack = 1e-13

        def loosens_up(t, y):
            return self.left(y[0], y[2]) - self.friction * 2 * self.arm * math.sin(y[0]) - slack

        def loosens_down(t, y):
            return -self.left(y[0], y[2]) - self.friction * 2 * self.arm * math.sin(y[0]) - slack

        def turns(t, y):
            return y[1] * mode

        def at_low(t, y):
            return y[0] - self.low

        def at_high(t, y):
            return self.high - y[0]

        def switches(t, y):
            above = self.lift(y[0]) - self.e["throttle"].get("switch", math.inf)
            return -above if self.open else above

        moves = mode if self.friction or mode == STICKS else 1e-300

        def is_extreme(t, y):
            return self.rates(y, moves, load)[2]

        if mode == STICKS:
            watched = [loosens_up, loosens_down]
            for event in watched:
                event.direction, event.terminal = 1, True
            if y[0] >= self.high:
                loosens_up.terminal = False
            if y[0] <= self.low:
                loosens_down.terminal = False
        else:
            watched = [turns, at_low, at_high, switches]
            for event in watched:
                event.direction, event.terminal = -1, True
            if not self.friction:
                turns.terminal = False
        return solve_ivp(
            lambda t, y: self.rates(y, moves, load), (t, duration), y, dense_output=True,
            method="DOP853", rtol=1e-12, atol=1e-13, events=[*watched, is_extreme], max_step=duration / 100,
        )  # fmt: skip

    def following(self, y, mode, came, hits):
        if mode == STICKS:
            y[1] = 0.0
            up = came[0] and y[0] < self.high
            # Off the stop by less than what counts, so that the next event isn't this one.
            y[0] = min(max(y[0], self.low + 1e-14), self.high - 1e-14)
            return RISES if up else FALLS
        if came[3]:
            self.open = not self.open
            # Past the switch, lest rounding leave it on this side.
            y[0] += math.copysign(1e-14, y[1])
            return mode
        if came[1] or came[2]:
            hits[0] += came[1]
            hits[1] += came[2]
            y[0] = self.low if came[1] else self.high
        y[1] = 0.0
        hindering = self.friction * 2 * self.arm * math.sin(y[0])
        force = self.left(y[0], y[2])
        if (came[1] and force <= hindering) or (came[2] and force >= -hindering) or abs(force) <= hindering:
            return STICKS
        # Under way by less than what counts, so that the next event isn't this one.
        y[1] = math.copysign(1e-14, force)
        return RISES if force > 0 else FALLS
