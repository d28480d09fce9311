"""Profiles of cams: rolled back under a follower found by searching for contact; curvature with many digits."""

import cmath
import math

import mpmath
import numpy as np
import pytest
from cam_samples import CAMS, cam_of

from engine import cam_curves

DENSE = 20_000


@pytest.mark.parametrize("name", CAMS)
def test_follower_on_the_made_profile__moves_by_the_law(name):
    """The profile's points, as a cam that is made of them would lie, push the follower as far as the law says.

    Points of the surface lie at most 1e-5 m from the true contact; the follower there is too low by half the square of
    that times the curvatures' sum, 150/m at most.
    """
    cam = cam_of(CAMS[name])
    curves = cam_curves(cam, DENSE)
    for degrees in (20.0, 55.0, 90.0, 120.0, 160.0, 205.0, 240.0, 300.0):
        phi = math.radians(degrees)
        found = pushed_by(curves.profile * cmath.exp(1j * curves.sense * phi), cam)
        expected = np.interp(phi, curves.angle, curves.displacement)
        assert found == pytest.approx(expected, abs=1e-8 if cam.translating else 2e-7), degrees


def pushed_by(surface, cam):
    """Displacement of the follower on a surface of points."""
    follower = cam.follower
    if cam.translating:
        if follower.contact == "flat":
            return surface.imag.max() - cam.base_radius
        radius = follower.roller_radius or 0.0
        aside = surface.real - follower.offset
        if radius:
            near = np.abs(aside) <= radius
            height = (surface.imag[near] + np.sqrt(radius**2 - aside[near] ** 2)).max()
        else:
            upper = surface.imag > 0
            order = np.argsort(aside[upper])
            height = np.interp(0.0, aside[upper][order], surface.imag[upper][order])
        return height - math.sqrt((cam.base_radius + radius) ** 2 - follower.offset**2)
    distance, arm = follower.pivot_distance, follower.arm
    from_pivot = surface - distance
    bearing = np.angle(-from_pivot.conj())
    if follower.contact == "flat":
        return bearing.max() - math.asin(cam.base_radius / distance)
    radius, far = follower.roller_radius, np.abs(from_pivot)
    # The roller touches a point at the end of the arm when the three lengths make a triangle.
    cosine = (arm**2 + far**2 - radius**2) / (2 * arm * far)
    reached = np.abs(cosine) <= 1
    psi = bearing[reached] + np.arccos(cosine[reached])
    return psi.max() - math.acos((arm**2 + distance**2 - (cam.base_radius + radius) ** 2) / (2 * arm * distance))


def displacement(u):
    """Rise of the roller's cam at many digits: a modified sine's middle."""
    return (2 + mpmath.pi * u - mpmath.mpf(9) / 4 * mpmath.sin(4 * mpmath.pi * u / 3 + mpmath.pi / 3)) / (4 + mpmath.pi)


@pytest.mark.parametrize("name", ["roller", "arm", "arm with"])
@pytest.mark.parametrize("u", [0.2, 0.45, 0.7])
def test_curvature_and_pressure_angle__with_many_digits(name, u):
    """The path of the roller's centre in the cam's axes, differentiated by mpmath at 50 digits."""
    cam = cam_of(CAMS[name])
    beta = cam.sections["out"].angle
    curves = cam_curves(cam, 3600)
    k = int(np.argmin(np.abs(curves.angle - u * beta)))
    follower, sense = cam.follower, curves.sense
    with mpmath.workdps(50):
        at = mpmath.mpf(float(curves.angle[k]))
        stroke = mpmath.mpf(cam.stroke_of(cam.sections["out"]))
        r = mpmath.mpf(cam.base_radius) + mpmath.mpf(follower.roller_radius)

        def s(phi):
            return stroke * displacement(phi / mpmath.mpf(beta))

        def centre(phi):
            if cam.translating:
                e = mpmath.mpf(follower.offset)
                return mpmath.mpc(e, mpmath.sqrt(r * r - e * e) + s(phi))
            d, arm = mpmath.mpf(follower.pivot_distance), mpmath.mpf(follower.arm)
            psi = mpmath.acos((arm**2 + d**2 - r * r) / (2 * arm * d)) + s(phi)
            return d - arm * mpmath.expj(-psi)

        def pitch(phi):
            return centre(phi) * mpmath.expj(-sense * phi)

        z1, z2 = mpmath.diff(pitch, at), mpmath.diff(pitch, at, 2)
        kappa = -sense * (mpmath.conj(z1) * z2).imag / abs(z1) ** 3
        normal = 1j * sense * z1 / abs(z1) * mpmath.expj(sense * at)
        velocity = mpmath.diff(centre, at)
        cosine = (normal * mpmath.conj(velocity)).real / abs(velocity)
    profile = 1.0 / (1.0 / float(kappa) - follower.roller_radius)
    # Sums of a dozen terms, none above a hundred times the result.
    assert curves.curvature[k] == pytest.approx(profile, rel=1e-12)
    assert math.cos(curves.pressure_angle[k]) == pytest.approx(float(cosine), rel=1e-13)


def test_undercut_face__is_pushed_further_than_the_law():
    """Beyond the limit the envelope crosses itself: points of it stand out where the law has the face already back."""
    cam = cam_of(CAMS["face"], base_radius="30 mm")
    curves = cam_curves(cam, DENSE)
    assert curves.curvature.min() < 0
    off = []
    for degrees in range(150, 180, 5):
        phi = math.radians(degrees)
        surface = curves.profile * cmath.exp(1j * phi) - cam.follower.pivot_distance
        pushed = np.angle(-surface.conj()).max() - math.asin(cam.base_radius / cam.follower.pivot_distance)
        off.append(pushed - np.interp(phi, curves.angle, curves.displacement))
    assert max(off) > 1e-4
    assert min(off) > -2e-7
