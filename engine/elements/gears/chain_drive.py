"""Chain drives: mean ratio, speed ripple, tension, number of links for a centre distance."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Answers, Element, NamedRows, Numbers, nudged
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, path, plan
from engine.parts.skeleton import AngularSpeed, Length, Moment, Number, quantity
from engine.words.quantity import main_result
from engine.words.verdicts import Verdict

# Links that engage over the range drawn.
_LINKS = 3


class ChainDrive(Element):
    """A chain of a given `pitch` over two sprockets; `moment` is the load torque on the driven one.

    A desired centre `distance` gives the number of links, and the centre distance with an even number; the chain's
    `linear_density` gives its centrifugal tension.
    """

    picture: ClassVar = "chain"

    type: Literal["chain_drive"]
    pitch: Annotated[Length, Field(gt=0)]
    driving_teeth: Annotated[Number, Field(ge=3)]
    driven_teeth: Annotated[Number, Field(ge=3)]
    speed: AngularSpeed
    moment: Annotated[Moment, Field(ge=0)]
    distance: Annotated[Length, Field(gt=0)] | None = None
    linear_density: Annotated[quantity("linear_density"), Field(gt=0)] | None = None

    def named(self, n: Numbers, even: np.ndarray | None = None) -> NamedRows:
        """Results of a set of variants.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
        even : ndarray, optional
            Links of the chain; default: the nearest even number.
        """
        z1, z2, p, speed = n["driving_teeth"], n["driven_teeth"], n["pitch"], n["speed"]
        d1, d2 = pitch_circle(p, z1), pitch_circle(p, z2)
        mean = np.abs(speed) * z1 * p / math.tau
        yield main_result("ratio", "mean speed of the driving sprocket over that of the driven one", "1"), z2 / z1
        yield main_result("driven_speed", "mean angular speed of the driven sprocket", "rad s-1"), speed * z1 / z2
        yield main_result("driving_diameter", "pitch diameter of the driving sprocket", "m"), d1
        yield main_result("driven_diameter", "pitch diameter of the driven sprocket", "m"), d2
        yield main_result("chain_speed", "mean speed of the chain", "m s-1"), mean
        yield main_result("greatest_chain_speed", "maximum speed of the chain", "m s-1"), 0.5 * np.abs(speed) * d1
        words = "speed ripple of the chain: (maximum − minimum)/maximum"
        yield main_result("speed_ripple", words, "1"), 2.0 * np.sin(0.5 * math.pi / z1) ** 2
        words = "peak acceleration of the chain (polygon effect)"
        yield main_result("greatest_acceleration", words, "m s-2"), 0.5 * speed**2 * p
        words = "force in the tight strand that turns the driven sprocket"
        yield main_result("pull", words, "N"), 2.0 * n["moment"] / d2
        yield main_result("driving_moment", "mean drive torque", "N m"), n["moment"] * z1 / z2
        if "distance" in n:
            links = _even_links(n) if even is None else np.tile(even, p.size // even.size)
            straight = links - 0.5 * (z1 + z2)
            root = np.sqrt(straight**2 - 8.0 * ((z2 - z1) / math.tau) ** 2)
            yield main_result("links", "links for the desired centre distance, before rounding", "1"), _links(n)
            words = "centre distance with the nearest even number of links"
            yield main_result("fitted_distance", words, "m"), 0.25 * p * (straight + root)
        if "linear_density" in n:
            words = "centrifugal tension of the chain"
            yield main_result("centrifugal_tension", words, "N"), n["linear_density"] * mean**2

    def evaluate(self, n: Numbers) -> Answers:
        """Results, and verdicts: fractional teeth do not fit, nor does a centre distance below the sum of the radii."""
        # The number of links is an integer: keep it while the numbers are nudged.
        even = _even_links(n) if "distance" in n else None
        found, errors = nudged(lambda m: {result.name: row for result, row in self.named(m, even)}, n)
        whole = (n["driving_teeth"] == np.rint(n["driving_teeth"])) & (n["driven_teeth"] == np.rint(n["driven_teeth"]))
        verdicts = np.where(whole, Verdict.OK, Verdict.FRACTION_OF_A_TOOTH).astype(np.uint8)
        if "distance" in n:
            radii = 0.5 * (found["driving_diameter"] + found["driven_diameter"])
            # With one link fewer the sprockets may touch.
            apart = (n["distance"] > radii) & (found["fitted_distance"] > radii)
            verdicts[whole & ~apart] = Verdict.DOES_NOT_FIT
        values = {name: np.where(verdicts == Verdict.OK, row, np.nan) for name, row in found.items()}
        return Answers(values, errors, verdicts)

    def panels(self) -> tuple[Panel, ...]:
        """The chain on its sprockets, to scale, and its speed while links engage.

        The speed is ω R cos β of the joint that carries the strand, within half a pitch angle of the tangent point.
        """
        pitch_angle, own = math.tau / self.driving_teeth, self.own_values()
        angle = np.linspace(0.0, _LINKS * pitch_angle, _LINKS * 241)
        from_tangent = np.mod(angle, pitch_angle) - 0.5 * pitch_angle
        curve = Curve("", own["greatest_chain_speed"] * np.cos(from_tangent))
        x, y = PanelAxis("angle of the driving sprocket", "rad", "φ_1"), PanelAxis("speed of the chain", "m s-1", "v")
        return self._layout(), Panel(x, y, angle, (curve,), (Mark("mean", None, own["chain_speed"]),))

    def _layout(self) -> Panel:
        """Both pitch circles with the chain; the default centre distance is the sum of both diameters."""
        own = self.own_values()
        radii = 0.5 * own["driving_diameter"], 0.5 * own["driven_diameter"]
        distance = 2.0 * sum(radii) if self.distance is None else self.distance
        # Both strands are tangent to the circles, perpendicular to the radii.
        lean = math.acos(max(-1.0, min(1.0, (radii[0] - radii[1]) / distance)))
        arcs = np.linspace(lean, math.tau - lean, 241), np.linspace(-lean, lean, 241)
        ends = (0.0, radii[0], arcs[0]), (distance, radii[1], arcs[1])
        chain = np.concatenate([centre + radius * np.exp(1j * arc) for centre, radius, arc in ends])
        # The driving sprocket pulls the strand on the side that moves towards it.
        tight = np.exp(1j * math.copysign(lean, self.speed))
        teeth, lines = (self.driving_teeth, self.driven_teeth), []
        for (centre, radius, _), count, way in zip(ends, teeth, ("drives", "driven"), strict=True):
            joints = centre + radius * np.exp(1j * math.tau * np.arange(round(count) + 1) / count)
            lines.append(path(f"z = {count:g}, {way}", joints))
        strand = path("tight strand", [centre + radius * tight for centre, radius, _ in ends])
        return plan((path("chain", np.append(chain, chain[0])), *lines, strand))


def pitch_circle(pitch: np.ndarray, teeth: np.ndarray) -> np.ndarray:
    """Pitch diameter of a sprocket, the circle of the chain joints, p/sin(π/z)."""
    return pitch / np.sin(math.pi / teeth)


def _links(n: Numbers) -> np.ndarray:
    """Length of a chain in links, 2a/p + (z₁+z₂)/2 + ((z₂−z₁)/2π)² p/a (ISO 10823)."""
    z1, z2 = n["driving_teeth"], n["driven_teeth"]
    span = n["distance"] / n["pitch"]
    return 2.0 * span + 0.5 * (z1 + z2) + ((z2 - z1) / math.tau) ** 2 / span


def _even_links(n: Numbers) -> np.ndarray:
    """The nearest even number of links."""
    return 2.0 * np.rint(0.5 * _links(n))
