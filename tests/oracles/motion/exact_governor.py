"""Governors with many digits, by their geometry in angles and the virtual work of weights and springs."""

import mpmath as mp


def places(governor, angle):
    """Radius and height of a ball, and height of the sleeve, at an angle of the upper arm or of the bell crank."""
    n = {key: mp.mpf(value) for key, value in governor.items() if isinstance(value, (int, float))}
    if governor["type"] == "hartnell_governor":
        ball = n["pivot_radius"] + n["ball_arm"] * mp.expj(mp.pi / 2 - angle)
        return ball.real, ball.imag, (n["sleeve_arm"] * mp.expj(mp.pi - angle)).imag
    top = n.get("upper_pivot", mp.mpf(0))
    joint = top - 1j * n["upper_arm"] * mp.expj(angle)
    # The pin on the sleeve is below the joint, a lower arm away.
    across = joint.real - n.get("lower_pivot", mp.mpf(0))
    pin = joint - across - 1j * mp.sqrt(n["lower_arm"] ** 2 - across**2)
    if governor["type"] == "proell_governor":
        parallel = n["parallel_radius"] - n.get("lower_pivot", mp.mpf(0))
        turn = mp.asin(parallel / n["lower_arm"])
        ball = joint + n["extension"] * (joint - pin) / n["lower_arm"] * mp.expj(turn)
    else:
        ball = top + (joint - top) * n.get("ball_arm", n["upper_arm"]) / n["upper_arm"]
    return ball.real, ball.imag, pin.imag


def angle_at(governor, radius, guess):
    # Two beginnings near each other: a secant from farther may end where arms don't reach.
    return mp.findroot(lambda a: places(governor, a)[0] - radius, (guess, guess + mp.mpf("0.001")))


def first_guess(governor):
    """An angle near the inner stop."""
    if governor["type"] == "hartnell_governor":
        return mp.asin((mp.mpf(governor["least_radius"]) - governor["pivot_radius"]) / governor["ball_arm"])
    top, arm = governor.get("upper_pivot", 0.0), governor.get("ball_arm", governor["upper_arm"])
    radius = governor["least_radius"]
    if governor["type"] == "proell_governor":
        radius = min(radius, 0.99 * governor["upper_arm"])
    return mp.asin((mp.mpf(radius) - top) / arm)


class ExactGovernor:
    """Equilibrium of a governor at radii of its balls."""

    def __init__(self, governor, guess=None):
        self.governor = governor
        inner = mp.mpf(governor["least_radius"])
        self.inner = angle_at(governor, inner, first_guess(governor) if guess is None else guess)
        self.zero = places(governor, self.inner)[2]

    def angle(self, radius):
        return angle_at(self.governor, mp.mpf(radius), self.inner + mp.mpf("0.05"))

    def potential(self, angle):
        g = self.governor
        gravity = mp.mpf(g.get("gravity", 9.80665))
        lift = places(g, angle)[2] - self.zero
        spring = mp.mpf(g.get("preload", 0.0)) * lift + mp.mpf(g.get("stiffness", 0.0)) * lift**2 / 2
        balls = 2 * mp.mpf(g["ball_mass"]) * places(g, angle)[1]
        return (balls + mp.mpf(g.get("sleeve_mass", 0.0)) * lift) * gravity + spring

    def inertia(self, angle):
        """J of the balls about the axis."""
        return 2 * mp.mpf(self.governor["ball_mass"]) * places(self.governor, angle)[0] ** 2

    def rates(self, angle):
        """Derivatives of V, r and z by the angle."""
        return (
            mp.diff(self.potential, angle),
            mp.diff(lambda a: places(self.governor, a)[0], angle),
            mp.diff(lambda a: places(self.governor, a)[2], angle),
        )

    def force(self, angle):
        v, r, _ = self.rates(angle)
        return v / (2 * r)

    def sleeve_force(self, angle):
        v, _, z = self.rates(angle)
        return v / z

    def speed(self, angle):
        return mp.sqrt(self.speed_squared(angle))

    def speed_squared(self, angle):
        return 2 * mp.diff(self.potential, angle) / mp.diff(self.inertia, angle)

    def margin(self, angle):
        """(dω²/dr) r/ω²."""
        radius = places(self.governor, angle)[0]
        return mp.diff(self.speed_squared, angle) / self.rates(angle)[1] * radius / self.speed_squared(angle)

    def lift(self, angle):
        return places(self.governor, angle)[2] - self.zero

    def sleeve_mass(self, angle):
        """Mass at the sleeve of the kinetic energy."""
        r, h, z = (mp.diff(lambda a, k=k: places(self.governor, a)[k], angle) for k in range(3))
        balls = 2 * mp.mpf(self.governor["ball_mass"]) * (r**2 + h**2)
        return balls / z**2 + mp.mpf(self.governor.get("sleeve_mass", 0.0))

    def sleeve_stiffness(self, angle):
        """Force at the sleeve for each metre of lift, the speed held."""
        held = self.speed(angle) ** 2

        def left(a):
            v, _, z = self.rates(a)
            return (v - held * mp.diff(self.inertia, a) / 2) / z

        return mp.diff(left, angle) / self.rates(angle)[2]
