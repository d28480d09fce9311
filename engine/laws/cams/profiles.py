"""Geometry of a cam and its follower: pressure angle, curvature, contact of a flat face.

The cam turns by φ, counter-clockwise, about the origin. Primes are derivatives by φ. A translating follower moves along
y at x = e. An oscillating one has its pivot at (d, 0); its arm, above the line of centres, makes the angle ψ with that
line and opens against the cam's rotation (`sense` = 1) or with it (−1). Statements about the pitch curve hold for the
path of a roller's centre and for a knife edge.

Source: the envelope of the follower's positions in the axes of the cam.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.elementary import direction_of

Place = tuple[float, float, float, float, float, float]


@scalar
def least_height(prime_radius: float, offset: float) -> float:
    """Height s₀ of a translating follower above the cam's axis at its lowest point; NaN for too large an offset."""
    return math.sqrt((prime_radius - offset) * (prime_radius + offset))


@scalar
def least_arm_angle(prime_radius: float, arm: float, distance: float) -> float:
    """Angle ψ₀ of an arm whose end lies on the prime circle; NaN if it doesn't reach it.

    The half-angle formula avoids cancellation where the arm is nearly in line.
    """
    near = (prime_radius - distance + arm) * (prime_radius + distance - arm)
    far = (distance + arm - prime_radius) * (distance + arm + prime_radius)
    return 2.0 * math.atan(math.sqrt(near / far))


@scalar
def translating_place(offset: float, y: float, s1: float, s2: float) -> Place:
    """Centre of a translating follower's roller and its first two derivatives, x and y of each."""
    return offset, y, 0.0, s1, 0.0, s2


@scalar
def oscillating_place(arm: float, distance: float, psi: float, s1: float, s2: float) -> Place:
    """Centre of an oscillating follower's roller and its first two derivatives, x and y of each."""
    c, s = direction_of(psi)
    return (
        distance - arm * c,
        arm * s,
        arm * s * s1,
        arm * c * s1,
        arm * (c * s1 * s1 + s * s2),
        arm * (c * s2 - s * s1 * s1),
    )


@scalar
def rolled_back(place: Place, sense: float) -> tuple[float, float, float, float]:
    """Derivatives z', z'' of the pitch curve, in axes that coincide with the frame's; the cam turns by `sense` × φ."""
    x, y, x1, y1, x2, y2 = place
    return (
        x1 + sense * y,
        y1 - sense * x,
        x2 + 2.0 * sense * y1 - x,
        y2 - 2.0 * sense * x1 - y,
    )


@scalar
def pitch_curvature(place: Place, sense: float) -> float:
    """Curvature of the pitch curve, positive where it is convex."""
    x1, y1, x2, y2 = rolled_back(place, sense)
    square = x1 * x1 + y1 * y1
    return -sense * (x1 * y2 - y1 * x2) / (square * math.sqrt(square))


@scalar
def flat_face_support(distance: float, psi: float, s1: float, s2: float, sense: float) -> tuple[float, float]:
    """Contact of an oscillating flat face whose plane passes through its pivot.

    Returns
    -------
    radius : float
        Radius of curvature of the cam: p + d²p/dθ², where p = d sin ψ is the distance of the face from the cam's axis
        and θ the face's rotation relative to the cam.
    place : float
        Distance of the contact from the pivot.
    """
    c, s = direction_of(psi)
    turn, turned = 1.0 + sense * s1, sense * s2
    p1, p2 = distance * c * s1, distance * (c * s2 - s * s1 * s1)
    return distance * s + (p2 * turn - p1 * turned) / turn**3, distance * c / turn


@scalar
def least_face_angle(base_radius: float, distance: float) -> float:
    """Angle ψ₀ of a flat face through its pivot that touches the base circle; NaN for a pivot inside the circle."""
    return math.asin(base_radius / distance)


@scalar
def contact_normal(x: float, y: float, x1: float, y1: float, sense: float) -> tuple[float, float]:
    """Unit normal of the pitch curve, from the cam to its follower.

    With w the position of the roller's centre, it is w − sense · (y', −x'), normalised: perpendicular to the velocity
    of the centre relative to the cam.

    Parameters
    ----------
    x, y, x1, y1 : float
        Position of the centre from the cam's axis, and its derivative by the cam's angle.
    sense : float
        1 if the cam turns counter-clockwise, −1 if clockwise.
    """
    nx, ny = x - sense * y1, y + sense * x1
    per_length = 1.0 / math.sqrt(nx * nx + ny * ny)
    return nx * per_length, ny * per_length


@scalar
def sliding_roller(offset: float, y: float, s1: float, s2: float) -> tuple[float, float, float]:
    """Components of the normal across and along a translating follower's motion, and curvature of the pitch curve.

    The ratio of the components is tan α.
    """
    return s1 - offset, y, pitch_curvature(translating_place(offset, y, s1, s2), 1.0)


@scalar
def swinging_roller(
    arm: float, distance: float, psi: float, s1: float, s2: float, sense: float
) -> tuple[float, float, float]:
    """Components of the normal along and across an oscillating follower's arm, and curvature of the pitch curve.

    The ratio of the components is tan α.
    """
    c, s = direction_of(psi)
    along, across = arm * (1.0 + sense * s1) - distance * c, distance * s
    return along, across, pitch_curvature(oscillating_place(arm, distance, psi, s1, s2), sense)


@scalar
def sliding_face_transmission(height: float) -> float:
    """Cosine of the pressure angle of a translating flat face: 1, since the angle is zero; NaN below the cam's axis."""
    return 1.0 if height > 0.0 else math.nan


@scalar
def swinging_face_transmission(psi: float, s1: float, sense: float) -> float:
    """Measure of force transmission by a flat face through its pivot: 0 for contact at the pivot or at infinity."""
    cosine, _ = direction_of(psi)
    return cosine * (1.0 + sense * s1)


@scalar
def least_height_for_curvature(s: float, s1: float, s2: float, offset: float, radius: float) -> float:
    """Height s₀ above which the curvature of a translating follower's pitch curve at s stays below 1/`radius`.

    With y the largest root of R³ = ρ(R² + v s' − y s''), R² = y² + v², v = s' − e, the height is y − s. Newton's method
    starts from above, in a bracket. Only roots above y = s are sought: without one, any height suffices and the result
    is 0.
    """
    v = s1 - offset
    least_y = max(s, 0.0)
    low, high = least_y, radius + math.sqrt(radius * abs(s2)) + (radius * abs(v * s1)) ** (1.0 / 3.0)
    # Above this bound R³ exceeds the rest: each term is less than a third of R³ beyond three times its own bound.
    high = 3.0 * high
    if high <= low:
        return 0.0
    least = math.sqrt(low * low + v * v)
    bends_up = 3.0 * (least * least + low * low) >= 2.0 * radius * least
    y = high
    for _ in range(100):
        square = y * y + v * v
        r = math.sqrt(square)
        f = r * square - radius * (square + v * s1 - y * s2)
        if f >= 0.0:
            high = y
        else:
            low = y
        slope = 3.0 * r * y - radius * (2.0 * y - s2)
        new = y - f / slope if slope > 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            # From above, Newton's method stays above the root of a function convex upwards; a step below the lowest y
            # shows that there is no root.
            if f >= 0.0 and low == least_y and (bends_up or high - low <= 1e-6 * radius):
                return 0.0
            new = 0.5 * (low + high)
        if abs(new - y) <= 2e-16 * high:
            break
        y = new
    return y - s


@scalar
def arm_angles_for_pressure(s1: float, arm: float, distance: float, sense: float, slope: float) -> tuple[float, float]:
    """Minimum and maximum angle ψ of an arm for which |tan α| is at most `slope`; NaN if there is none.

    |a(1 ± s') − d cos ψ| ≤ d sin ψ tan δ means cos(ψ − δ) ≥ cos A ≥ cos(ψ + δ), where cos A = a(1 ± s') cos δ/d.
    """
    limit = math.atan(slope)
    middle = math.acos(arm * (1.0 + sense * s1) * math.cos(limit) / distance)
    return abs(middle - limit), math.pi - abs(math.pi - middle - limit)


@scalar
def curvature_room(
    psi: float, s1: float, s2: float, arm: float, distance: float, sense: float, radius: float
) -> tuple[float, float, float]:
    """Margin of the pitch curve of an arm against a curvature of 1/`radius`: f = |z'|³ − `radius`·κ|z'|³ ≥ 0.

    With w = 1 ± s', |z'|² = a²w² + d² − 2adw cos ψ and κ|z'|³ = a²w³ + d² − ad((w + w²) cos ψ + s'' sin ψ).

    Returns
    -------
    f, f_psi, bend : float
        f, its derivative by ψ, and a bound of its second derivative for all ψ.
    """
    w = 1.0 + sense * s1
    c, s = direction_of(psi)
    both, reach = w + w * w, 2.0 * arm * distance * w
    square = (arm * w - distance * c) ** 2 + (distance * s) ** 2
    rate = math.sqrt(square)
    bent = (arm * w) ** 2 * w + distance**2 - arm * distance * (both * c + s2 * s)
    slope = 1.5 * rate * reach * s - radius * arm * distance * (both * s - s2 * c)
    turning = radius * arm * distance * math.sqrt(both * both + s2 * s2)
    return rate * square - radius * bent, slope, 3.0 * (abs(arm * w) + distance) * abs(reach) + turning


@scalar
def face_room(
    psi: float, s1: float, s2: float, distance: float, sense: float, radius: float
) -> tuple[float, float, float]:
    """Margin of the radius of curvature above `radius` under a flat face through its pivot; see `curvature_room`.

    With t = 1 ± s' the radius is d((1 − (s'/t)²) sin ψ + s''/t³ cos ψ).
    """
    turn = 1.0 + sense * s1
    straight, bent = 1.0 - (s1 / turn) ** 2, s2 / turn**3
    c, s = direction_of(psi)
    bound = distance * (abs(straight) + abs(bent))
    return distance * (straight * s + bent * c) - radius, distance * (straight * c - bent * s), bound
