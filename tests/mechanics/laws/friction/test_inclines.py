"""Inclines and wedges, elements of a scene, against equilibrium solved as it stands."""

import math

import mpmath
import numpy as np
from element_samples import INCLINE, WEDGE, element
from friction_ranges import frictions, quick, sizes, slopes
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf

EPS = np.finfo(float).eps

# Inclines and wedges


def forces_on(sample, *names, **numbers):
    """Forces on an element with these numbers; infinite where it jams, NaN where it has none."""
    with np.errstate(all="ignore"):
        found = element(sample).values({key: np.array([value]) for key, value in numbers.items()})
    return [float(found[name][0]) for name in names]


def equilibrium(columns, forces):
    """Solution of two equations of equilibrium at 50 digits."""
    with mpmath.workdps(50):
        return mpmath.lu_solve(mpmath.matrix(columns).T, mpmath.matrix(forces))


@quick
@given(st.floats(0.0, 1.5), st.floats(-1.5, 1.5), frictions, sizes)
def test_incline__is_in_equilibrium_both_ways(angle, pull_angle, friction, load):
    numbers = {"load": load, "angle": angle, "friction": friction, "pull_angle": pull_angle}
    both = forces_on(INCLINE, "up_force", "down_force", **numbers)
    with mpmath.workdps(50):
        a, b, f, q = (mpf(v) for v in (angle, pull_angle, friction, load))
        weight = [q * mpmath.sin(a), q * mpmath.cos(a)]
        for got, way in zip(both, (1, -1), strict=True):
            # Unknown: the pull along the slope and across it, and the normal force with friction against the motion.
            columns = [[way * mpmath.cos(b), way * mpmath.sin(b)], [-way * f, mpf(1)]]
            left = mpmath.cos(b) + way * f * mpmath.sin(b)
            if abs(mpmath.cos(a + b)) < 1e-12 or abs(left) < 1e-12:
                continue
            force, normal = equilibrium(columns, weight)
            if mpmath.cos(a + b) <= 0:
                assert math.isnan(got)
            elif left <= 0:
                assert math.isnan(got) if (way < 0 and f < mpmath.tan(a)) else got == math.inf
            else:
                assert normal > 0
                # Numerator and denominator may cancel, each from terms no greater than 1 + f.
                allowed = 8 * EPS * (1 + f) * (q + abs(force)) / left
                assert abs(mpf(got) - force) <= allowed


def wedge_by_equilibrium(way, load, slope, face, base, guide):
    """Force on a wedge and powers in it, from equations of equilibrium of wedge and load; side: of the guide."""
    with mpmath.workdps(50):
        t, f1, f2, f3, q = (mpf(v) for v in (slope, face, base, guide, load))
        cosine = 1 / mpmath.sqrt(1 + t * t)
        sine = t * cosine
        for side in (1, -1):
            # Of the load: across the guide and along it. Unknown: normal forces of the face n1 and of the guide n3.
            columns = [[sine + way * f1 * cosine, cosine - way * f1 * sine], [mpf(-side), -way * f3]]
            n1, n3 = equilibrium(columns, [mpf(0), q])
            if n1 > 0 and n3 >= 0:
                thrust, pressed = n1 * (sine + way * f1 * cosine), n1 * (cosine - way * f1 * sine)
                force = way * thrust + f2 * pressed
                # The wedge moves 1, the load rises t, the face slides 1/cos.
                lost = f1 * n1 / cosine + f2 * pressed + f3 * n3 * t
                return force, lost
        return None


@quick
@given(sizes, slopes, frictions, frictions, st.floats(0.0, 1.2))
def test_wedge__is_in_equilibrium_and_loses_what_friction_takes(load, slope, face, base, guide):
    friction = {"friction": face, "base_friction": base, "guide_friction": guide}
    both = forces_on(WEDGE, "drive_force", "withdraw_force", load=load, angle=math.atan(slope), **friction)
    for got, way in zip(both, (1, -1), strict=True):
        left = (1 - slope * face) - guide * (slope + face) if way > 0 else 1.0
        if min(abs(left), abs(1 - slope * face)) < 1e-12:
            continue
        expected = wedge_by_equilibrium(way, load, slope, face, base, guide)
        if expected is None:
            assert got == math.inf
            continue
        force, lost = expected
        # Errors of the slope and of two denominators that near jamming approach 0, and cancelling in the withdrawal.
        allowed = (16 + 12 / abs(left)) * EPS * (abs(force) + load * (1 + slope + base))
        assert abs(mpf(got) - force) <= allowed
        with mpmath.workdps(30):
            assert abs(force - way * mpf(load) * mpf(slope) - lost) <= mpf(10) ** -20 * (abs(force) + load * slope)
