"""A flywheel wound of tape or wire under tension: stresses at rest and at speed, and separation of its layers.

A layer wound with the stress σ_w at the radius s adds the pressure σ_w ds/s on the layers below. On a ring of the same
material with inner radius a, the layers up to b cause at the radius r of the winding

    σ_r = −σ_w (r² − a²)/(2r²) L,   σ_t = σ_w (1 − (r² + a²)/(2r²) L),   L = ln((b² − a²)/(r² − a²)),

and the pressure −σ_r(c) on the ring, whose outer radius is c. Rotation adds the stresses of a ring, with
K = (3 + ν)ρω²/8

    σ_r = K (b² − r²)(r² − a²)/r²,   σ_t = K (a² + b² + a²b²/r² − (1 + 3ν)/(3 + ν) r²).

Layers transmit no tension to each other: they separate where the sum makes σ_r > 0, the outermost layer first, at
ω² = 4σ_w/((3 + ν)ρ(b² − a²)). Above that speed these stresses are not valid.

Source: S. P. Timoshenko, Strength of Materials, Part II (wire-wound cylinders, rotating disks).
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Element, NamedRows, Numbers
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.elements.sampled_peak import sampled_peak
from engine.laws.masses.link_inertia import ring_inertia
from engine.parts.skeleton import AngularSpeed, Number, Positive, Pressure, quantity
from engine.words.quantity import main_result

_PLACES, _SHOWN = 257, 721


class WoundFlywheel(Element):
    """A flywheel of tape or wire, wound with the tension `winding_stress` on a ring of the same material.

    The ring extends from `bore` to `winding_diameter`, the winding from there to `diameter`. `strength` is that of the
    material.
    """

    ascending: ClassVar = {
        ("bore", "winding_diameter", "diameter"): "the winding lies outside the ring",
        ("winding_stress", "strength"): "the tape would tear while it is wound",
    }
    picture: ClassVar = "stresses"

    type: Literal["wound_flywheel"]
    bore: Positive
    winding_diameter: Positive
    diameter: Positive
    width: Positive
    density: Annotated[quantity("density"), Field(gt=0)]
    poisson_ratio: Annotated[Number, Field(ge=0, lt=0.5)] = 0.3
    winding_stress: Annotated[Pressure, Field(ge=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    strength: Annotated[Pressure, Field(gt=0)] | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants; NaN if the radii do not ascend."""
        a, c, b = (0.5 * n[key] for key in ("bore", "winding_diameter", "diameter"))
        nu, tension, speed = n["poisson_ratio"], n["winding_stress"], n["speed"]
        a, c, b, speed = (np.where((a < c) & (c < b), row, math.nan) for row in (a, c, b, speed))
        spin = (3.0 + nu) / 8.0 * n["density"] * speed**2
        mass = n["density"] * n["width"] * math.pi * (b - a) * (b + a)
        inertia = ring_inertia(mass, 2.0 * b, 2.0 * a)
        energy = 0.5 * inertia * speed**2

        # Next to a small bore the stresses fall off with the distance from it.
        places = np.clip(a + (c - a) * ((b - a) / (c - a)) ** np.linspace(0.0, 1.0, _PLACES)[:, None], c, b)
        stress, _ = sampled_peak(lambda r: wound_stresses(n, r, speed)[1], places)
        about = np.log1p((b - c) * (b + c) / ((c - a) * (c + a)))
        hollow = (c - a) * (c + a) / c**2
        pressure = 0.5 * tension * hollow * about
        spun = 2.0 * spin * (b**2 + (1.0 - nu) / (3.0 + nu) * a**2)
        parting = np.sqrt(4.0 * tension / ((3.0 + nu) * n["density"] * (b - a) * (b + a)))
        at_bore = spun - tension * about
        yield main_result("mass", "mass of the wheel", "kg"), mass
        yield main_result("inertia", "moment of inertia", "kg m2"), inertia
        yield main_result("energy", "kinetic energy at the speed", "J"), energy
        yield main_result("energy_per_mass", "kinetic energy per unit mass", "J kg-1"), energy / mass
        yield main_result("rim_speed", "speed at the outer radius", "m s-1"), speed * b
        yield main_result("winding_pressure", "pressure of the winding on the ring at rest", "Pa"), pressure
        words = "hoop stress of the bore at rest, negative in compression"
        yield main_result("rest_bore_stress", words, "Pa"), -tension * about
        yield main_result("bore_stress", "hoop stress of the bore at the speed", "Pa"), at_bore
        words = "hoop stress of the bore of such a wheel without winding"
        yield main_result("plain_bore_stress", words, "Pa"), spun
        yield main_result("layer_stress", "peak tension of the winding at the speed", "Pa"), stress
        spun_off = spin * (b - c) * (b + c) * hollow
        yield main_result("pressure", "pressure of the winding on the ring at the speed", "Pa"), pressure - spun_off
        yield main_result("parting_speed", "speed above which the outermost layer is loose", "rad s-1"), parting
        loose = np.where(np.isnan(speed), math.nan, speed > parting)
        yield main_result("parts", "whether layers are loose at the speed (1 or 0)", "1", exact=True), loose
        if "strength" in n:
            greatest = np.maximum(stress, at_bore)
            yield main_result("strength_share", "peak tension over the strength", "1"), greatest / n["strength"]

    def panels(self) -> tuple[Panel, ...]:
        """Hoop and radial stresses over the radius, at rest, at its speed, and at the speed of separation."""
        n = {key: float(value[0]) for key, value in self.own_numbers().items()}
        inner, edge, outer = (0.5 * n[key] for key in ("bore", "winding_diameter", "diameter"))
        ring, winding = np.linspace(inner, edge, _SHOWN), np.linspace(edge, outer, _SHOWN)
        # Keep the last sample of the ring just inside the edge, which belongs to the winding.
        radius = np.concatenate([np.minimum(ring, np.nextafter(edge, 0.0)), winding])
        parting = self.own_values()["parting_speed"]
        speeds = {"at its speed": self.speed, "where layers part": parting, "at rest": 0.0}
        if self.speed > parting:
            # Above it these stresses are not valid.
            del speeds["at its speed"]
        found = {words: wound_stresses(n, radius, speed) for words, speed in speeds.items()}
        marks = [Mark("the winding begins", edge, None)]
        strength = [] if self.strength is None else [Mark("strength", None, self.strength)]
        made = []
        for which, words, symbol, more in ((1, "hoop stress", "σ_t", strength), (0, "radial stress", "σ_r", [])):
            curves = [Curve(name, rows[which], name == "at rest") for name, rows in found.items()]
            axes = PanelAxis("radius", "m", "r"), PanelAxis(words, "Pa", symbol)
            made.append(Panel(*axes, radius, curves, (*marks, *more)))
        return tuple(made)


def wound_stresses(
    n: Mapping[str, float | np.ndarray], radius: np.ndarray, speed: float | np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Radial and hoop stress of a wound flywheel, in its ring and its winding.

    Parameters
    ----------
    n : mapping of str to float or ndarray
        The element's numbers by key.
    radius : ndarray
        Between bore and outer radius [m]; the boundary of ring and winding belongs to the winding.
    speed : float or ndarray
        [rad/s]; 0 for the wheel at rest.

    Returns
    -------
    radial, hoop : ndarray
        Tension is positive [Pa].
    """
    a, c, b = (0.5 * n[key] for key in ("bore", "winding_diameter", "diameter"))
    nu, tension = n["poisson_ratio"], n["winding_stress"]
    spin = (3.0 + nu) / 8.0 * n["density"] * speed**2
    # All layers press on the ring; those outside it press on each layer.
    within = np.maximum(radius, c)
    pressed = 0.5 * tension * np.log((b - a) * (b + a) / ((within - a) * (within + a)))
    own = np.where(radius >= c, tension, 0.0)
    radial = -pressed * (1.0 - (a / radius) ** 2)
    radial = radial + spin * (b - radius) * (b + radius) * (1.0 - (a / radius) ** 2)
    hoop = own - pressed * (1.0 + (a / radius) ** 2)
    hoop = hoop + spin * (a**2 + b**2 + (a * b / radius) ** 2 - (1.0 + 3.0 * nu) / (3.0 + nu) * radius**2)
    return radial, hoop
