"""The flywheel as a wheel: size, mass and stress for the required inertia.

The required inertia I is reduced to the input link; on a shaft that turns i times as fast, J = I/i² is equivalent.

- rim: a ring of radial thickness t, J = m(R² + r²)/2, r = R − t;
- disc: J = mR²/2;
- arms: a rim, straight arms (uniform rods from the hub to the inner radius of the rim) and a hub (a disc). The rim
  provides the rest of J;
- mean rim: a thin rim of mean diameter D, m = 4J/D²; its section m/(πDρ) = b t with b = k t. Speed and stress refer to
  the mean radius, as in textbooks.

The stress is that of a thin free rim, σ = ρv² at the outer radius. Arms bend the rim and add to it; the maximum stress
of a solid disc is (3 + ν)/8 of it, about 0.41. A ductile wheel yields before it bursts, until the stress is uniform
over the section: it bursts when the mean hoop stress, ρω²(R² + Rr + r²)/3, equals the material's strength (Robinson).
The burst speed neglects both the strength and the mass of the arms. A torque M that accelerates the wheel from its
maximum speed takes the time H/M to burst it, with the angular impulse H = J(ω_b − ω_max); the containment must then
absorb Jω_b²/2.

Sources: S. P. Timoshenko, Strength of Materials, Part II (rotating rims and discs); R. S. Khurmi and J. K. Gupta,
Theory of Machines, ch. 16 (dimensions of the flywheel rim); E. L. Robinson, Bursting tests of steam-turbine disk
wheels, Trans. ASME 66 (1944).
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.laws.masses.link_inertia import Value, disc_inertia, ring_inertia
from engine.parts.bodies import WheelForm


class Material(NamedTuple):
    """Material of a flywheel: density [kg/m³] and permissible rim speed [m/s]."""

    density: float
    rim_speed_limit: float


# Handbooks allow 45–90 m/s for cast iron, 70–120 m/s for steel; the lower limit needs no proof of strength.
# Textbooks limit cast iron rims on arms to 24–31 m/s; the user must give that limit. 7200 kg/m³: Khurmi and Gupta.
MATERIALS = {"cast iron": Material(7200.0, 45.0), "steel": Material(7850.0, 70.0)}


class Wheel(NamedTuple):
    """A designed flywheel; every attribute is an ndarray (variants,), 0 where no flywheel is needed.

    Attributes
    ----------
    diameter, mass, width, thickness : ndarray
        Outer diameter [m], mass with arms and hub [kg], width of the rim or disc [m] (0 if arms and hub suffice),
        radial thickness [m] (of a disc: its radius).
    rim_speed, rim_speed_share : ndarray
        Maximum speed at the outer radius, for a mean rim at the mean radius [m/s], and its ratio to the limit.
    hoop_stress : ndarray
        ρv² there [Pa].
    energy : ndarray
        Kinetic energy at the maximum speed [J].
    burst_speed, burst_margin : ndarray
        Speed of the input link at which the wheel bursts, magnitude [rad/s], and its ratio to the maximum speed; NaN
        without a strength.
    burst_energy : ndarray
        Kinetic energy of the wheel when it bursts [J].
    burst_impulse : ndarray
        Angular impulse about the input link that accelerates the wheel alone from its maximum speed to bursting
        [N·m·s]; negative if it bursts below its maximum speed.
    """

    diameter: np.ndarray
    mass: np.ndarray
    width: np.ndarray
    thickness: np.ndarray
    rim_speed: np.ndarray
    rim_speed_share: np.ndarray
    hoop_stress: np.ndarray
    energy: np.ndarray
    burst_speed: np.ndarray
    burst_margin: np.ndarray
    burst_energy: np.ndarray
    burst_impulse: np.ndarray


def make_wheel(form: WheelForm, inertia: Value, speed: Value, numbers: Mapping[str, Value]) -> Wheel:
    """Design the wheel for a required inertia.

    Parameters
    ----------
    form : WheelForm
    inertia : float or ndarray (variants,)
        I_F required on the input link [kg·m²]; no flywheel is needed if it is 0 or less.
    speed : float or ndarray (variants,)
        Maximum speed of the input link, of either sign [rad/s].
    numbers : mapping of path to float or ndarray (variants,)
        The form's numbers by their paths in the scene, such as "flywheel.wheel.diameter".

    Returns
    -------
    Wheel
        NaN where no such wheel exists: the hub reaches the rim, the rim reaches the axis, or shaft or input is at
        rest.
    """
    with np.errstate(all="ignore"):
        material, diameter, shaft_speed = _proportions(form, speed, numbers)
        ratio = np.abs(numbers["flywheel.wheel.ratio"])
        asked = inertia / ratio**2
        make = _mean_rim if form.type == "mean rim" else _solid
        outer, inner, width, mass, made = make(form, material.density, diameter, asked, numbers)
        rim_speed = shaft_speed * diameter / 2
        # Mean of ρω²r² over the section, for ω = 1.
        spread = material.density * (outer**2 + outer * inner + inner**2) / 12
        strength = np.nan if form.strength is None else numbers["flywheel.wheel.strength"]
        burst = np.sqrt(strength / spread)
        sizes = Wheel(
            diameter=outer,
            mass=mass,
            width=width,
            thickness=(outer - inner) / 2,
            rim_speed=rim_speed,
            rim_speed_share=rim_speed / material.rim_speed_limit,
            hoop_stress=material.density * rim_speed**2,
            energy=made * shaft_speed**2 / 2,
            burst_speed=burst / ratio,
            burst_margin=burst / shaft_speed,
            burst_energy=made * burst**2 / 2,
            # A torque on the input link is i times that on the wheel's shaft.
            burst_impulse=made * (burst - shaft_speed) * ratio,
        )
        # If one size is undefined, all are.
        defined = np.isfinite(sizes.energy) & np.isfinite(sizes.mass) & (shaft_speed > 0.0)
        return Wheel(*(np.where(inertia <= 0.0, 0.0, np.where(defined, size, np.nan)) for size in sizes))


class _Made(NamedTuple):
    """Diameters of rim or disc and width [m], mass with arms and hub [kg], moment of inertia [kg·m²]."""

    outer: Value
    inner: Value
    width: Value
    mass: Value
    inertia: Value


def _mean_rim(form: WheelForm, density: Value, mean: Value, asked: Value, numbers: Mapping[str, Value]) -> _Made:
    mass = 4 * asked / mean**2
    ratio = numbers["flywheel.wheel.width_ratio"]
    thickness = np.sqrt(mass / (math.pi * mean * density * ratio))
    mass = np.where(thickness < mean, mass, np.nan)
    return _Made(mean + thickness, mean - thickness, ratio * thickness, mass, mass * mean**2 / 4)


def _solid(form: WheelForm, density: Value, diameter: Value, asked: Value, numbers: Mapping[str, Value]) -> _Made:
    inner = 0.0 if form.type == "disc" else diameter * (1 - 2 * numbers["flywheel.wheel.thickness_ratio"])
    per_width = density * math.pi / 4 * (diameter**2 - inner**2)
    inertia_per_width = ring_inertia(per_width, diameter, inner)
    other_mass = other_inertia = 0.0
    if form.type == "arms":
        hub = numbers["flywheel.wheel.hub_diameter"]
        hub_mass = density * math.pi / 4 * hub**2 * numbers["flywheel.wheel.hub_width"]
        length = np.where(hub < inner, (inner - hub) / 2, np.nan)
        arms_mass = form.arms * density * numbers["flywheel.wheel.arm_area"] * length
        # A uniform rod along a radius from r to R: m(R² + Rr + r²)/3 about the axis.
        arms_inertia = arms_mass * (inner**2 + inner * hub + hub**2) / 12
        other_mass, other_inertia = hub_mass + arms_mass, disc_inertia(hub_mass, hub) + arms_inertia
    width = np.maximum((asked - other_inertia) / inertia_per_width, 0.0)
    return _Made(diameter, inner, width, other_mass + width * per_width, other_inertia + width * inertia_per_width)


def _proportions(form: WheelForm, speed: Value, numbers: Mapping[str, Value]) -> tuple[Material, Value, Value]:
    """Material, outer or mean diameter and shaft speed of the wheel; the diameter defaults to the material's limit."""
    usual = MATERIALS[form.material]
    given = {k: numbers[f"flywheel.wheel.{k}"] for k in usual._fields if getattr(form, k) is not None}
    material = usual._replace(**given)
    shaft_speed = np.abs(speed * numbers["flywheel.wheel.ratio"])
    for key in ("diameter", "mean_diameter"):
        if getattr(form, key) is not None:
            return material, numbers[f"flywheel.wheel.{key}"], shaft_speed
    return material, 2 * material.rim_speed_limit / shaft_speed, shaft_speed
