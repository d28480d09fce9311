"""The flywheel as a wheel: size, mass and stress of what gives the inertia asked for.

The inertia I asked for is reduced to the input link; on a shaft that turns i times as fast J = I/i² does the same.

- rim: a ring of radial thickness t, J = m(R² + r²)/2, r = R − t;
- disc: J = mR²/2;
- arms: a rim, straight arms as uniform rods from the hub's rim to the inner radius of the rim, and the hub, a disc.
  The rim takes what arms and hub leave of J;
- mean rim: a thin one of the mean diameter D, m = 4J/D²; its section m/(πDρ) is b t with b = k t. Speed and stress are
  those of the mean radius, as textbooks have it.

The stress is that of a thin free rim, σ = ρv² at the outer radius; arms bend a rim and add to it, and a solid disc's
greatest stress is (3 + ν)/8 of it, about 0.41. Spun up, a ductile wheel yields before it bursts, until all of its
section bears alike: it bursts when the mean hoop stress, ρω²(R² + Rr + r²)/3, is the material's strength (Robinson).
Arms count as bearing nothing and weighing nothing there. Until then a moment M that drives the wheel beyond its
greatest speed takes the time H/M, with the angular impulse H = J(ω_b − ω_max), and leaves Jω_b²/2 in it to be caught.

Sources: S. P. Timoshenko, Strength of Materials, Part II (rotating rims and discs); R. S. Khurmi and J. K. Gupta,
Theory of Machines, ch. 16 (dimensions of the flywheel rim); E. L. Robinson, Bursting tests of steam-turbine disk
wheels, Trans. ASME 66 (1944).
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.laws.masses.moments_of_inertia import Value, disc_inertia, ring_inertia
from engine.parts.skeleton import WheelForm


class Material(NamedTuple):
    """What a flywheel is made of: density [kg/m³] and the rim speed it may run at [m/s]."""

    density: float
    rim_speed_limit: float


# Handbooks allow 45–90 m/s for cast iron, 70–120 m/s for steel; the lower end holds without a proof of strength.
# For a cast iron rim on arms textbooks stay at 24–31 m/s: its limit is to be given. 7200 kg/m³: Khurmi and Gupta.
MATERIALS = {"cast iron": Material(7200.0, 45.0), "steel": Material(7850.0, 70.0)}


class Wheel(NamedTuple):
    """A flywheel as made; every attribute is an ndarray (variants,), 0 where no flywheel is needed.

    Attributes
    ----------
    diameter, mass, width, thickness : ndarray
        Outer diameter [m], mass with arms and hub [kg], width of the rim or disc [m]; width 0 where arms and hub
        alone suffice. Radial thickness [m], of a disc its radius.
    rim_speed, rim_speed_share : ndarray
        Greatest speed of the outer radius, of a mean rim the mean one [m/s], and its share of the limit.
    hoop_stress : ndarray
        ρv² there [Pa].
    energy : ndarray
        Kinetic energy at the greatest speed [J].
    burst_speed, burst_margin : ndarray
        Speed of the input link, by magnitude, at which the wheel bursts [rad/s], and how many times that is its
        greatest; NaN without a strength.
    burst_energy : ndarray
        Kinetic energy of the wheel when it bursts [J].
    burst_impulse : ndarray
        Angular impulse about the input link that takes the wheel alone from its greatest speed to bursting [N·m·s];
        below 0 where it has burst.
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


class _Section(NamedTuple):
    """What a wheel is made of besides its width: masses in kg, inertias in kg·m², for one metre of width."""

    mass_per_width: Value
    inertia_per_width: Value
    other_mass: Value = 0.0
    other_inertia: Value = 0.0


def make_wheel(form: WheelForm, inertia: Value, speed: Value, numbers: Mapping[str, Value]) -> Wheel:
    """The wheel that gives an inertia.

    Parameters
    ----------
    form : WheelForm
        What it is to be made as.
    inertia : float or ndarray (variants,)
        I_F asked for on the input link [kg·m²]; 0 or less: no flywheel is needed.
    speed : float or ndarray (variants,)
        Greatest speed of the input link, of either sign [rad/s].
    numbers : mapping of path to float or ndarray (variants,)
        The form's numbers by their paths in the scene, such as "flywheel.wheel.diameter".

    Returns
    -------
    Wheel
        NaN where there is no such wheel: a hub that reaches the rim, a rim that reaches its own middle, a shaft or
        input at rest.
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
            # A moment on the input link is 1/i of that on the wheel's shaft.
            burst_impulse=made * (burst - shaft_speed) * ratio,
        )
        # No number may look right beside a width that doesn't exist.
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
    section = _section(form, density, diameter, numbers)
    width = np.maximum((asked - section.other_inertia) / section.inertia_per_width, 0.0)
    made = section.other_inertia + width * section.inertia_per_width
    inner = 0.0 if form.type == "disc" else diameter * (1 - 2 * numbers["flywheel.wheel.thickness_ratio"])
    return _Made(diameter, inner, width, section.other_mass + width * section.mass_per_width, made)


def _proportions(form: WheelForm, speed: Value, numbers: Mapping[str, Value]) -> tuple[Material, Value, Value]:
    """Material, outer or mean diameter and speed of the wheel's shaft, as given or as the material allows."""
    usual = MATERIALS[form.material]
    material = Material(
        *(usual[i] if getattr(form, k) is None else numbers[f"flywheel.wheel.{k}"] for i, k in enumerate(usual._fields))
    )
    shaft_speed = np.abs(speed * numbers["flywheel.wheel.ratio"])
    for key in ("diameter", "mean_diameter"):
        if getattr(form, key) is not None:
            return material, numbers[f"flywheel.wheel.{key}"], shaft_speed
    return material, 2 * material.rim_speed_limit / shaft_speed, shaft_speed


def _section(form: WheelForm, density: Value, diameter: Value, numbers: Mapping[str, Value]) -> _Section:
    if form.type == "disc":
        mass = density * math.pi / 4 * diameter**2
        return _Section(mass, disc_inertia(mass, diameter))
    inner = diameter * (1 - 2 * numbers["flywheel.wheel.thickness_ratio"])
    mass = density * math.pi / 4 * (diameter**2 - inner**2)
    rim = _Section(mass, ring_inertia(mass, diameter, inner))
    if form.type == "rim":
        return rim
    hub = numbers["flywheel.wheel.hub_diameter"]
    hub_mass = density * math.pi / 4 * hub**2 * numbers["flywheel.wheel.hub_width"]
    length = np.where(hub < inner, (inner - hub) / 2, np.nan)
    arms_mass = form.arms * density * numbers["flywheel.wheel.arm_area"] * length
    # A uniform rod along a radius from r to R: m(R² + Rr + r²)/3 about the axis.
    arms_inertia = arms_mass * (inner**2 + inner * hub + hub**2) / 12
    return rim._replace(other_mass=hub_mass + arms_mass, other_inertia=disc_inertia(hub_mass, hub) + arms_inertia)
