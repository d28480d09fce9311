"""What is computed of chain drives: mean ratio, ripple of the speed, pull, links for a distance of the axes."""

import math
from collections.abc import Mapping
from functools import partial

import numpy as np

from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges
from engine.elements.gears.drive_elements import ChainDrive
from engine.verdicts import Verdict

_RESULTS = (
    ElementResult("ratio", "mean speed of the driving sprocket over that of the driven one", "1"),
    ElementResult("driven_speed", "mean angular speed of the driven sprocket", "rad s-1"),
    ElementResult("driving_diameter", "pitch diameter of the driving sprocket", "m"),
    ElementResult("driven_diameter", "pitch diameter of the driven sprocket", "m"),
    ElementResult("chain_speed", "mean speed of the chain", "m s-1"),
    ElementResult("greatest_chain_speed", "greatest speed of the chain", "m s-1"),
    ElementResult("speed_ripple", "least speed of the chain below its greatest, over that", "1"),
    ElementResult("greatest_acceleration", "greatest acceleration of the chain by its polygon", "m s-2"),
    ElementResult("pull", "force in the tight strand that turns the driven sprocket", "N"),
    ElementResult("driving_moment", "mean moment that drives", "N m"),
    ElementResult("links", "links for the distance wanted, before rounding", "1", "distance"),
    ElementResult("fitted_distance", "distance of the axes with the nearest even number of links", "m", "distance"),
    ElementResult("centrifugal_tension", "tension of the whole chain by its mass", "N", "linear_density"),
)


def chain_drive_law(drive: ChainDrive) -> LawOfArrays:
    """The law of a chain drive; teeth that aren't whole don't fit, nor do axes nearer than the sprockets are wide.

    Parameters
    ----------
    drive : ChainDrive
    """
    keys = ("pitch", "driving_teeth", "driven_teeth", "speed", "moment")
    keys += tuple(key for key in ("distance", "linear_density") if getattr(drive, key) is not None)

    def judged(table: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        n = dict(zip(keys, table, strict=True))
        fits = (n["driving_teeth"] == np.rint(n["driving_teeth"])) & (n["driven_teeth"] == np.rint(n["driven_teeth"]))
        if "distance" in n:
            radii = sum(0.5 * pitch_circle(n["pitch"], n[key]) for key in ("driving_teeth", "driven_teeth"))
            fits &= n["distance"] > radii
        # Links are counted: the number that is nearest stays the same where error figures are made.
        even = 2.0 * np.rint(0.5 * _links(n)) if "distance" in n else None
        values, sizes = with_nudges(partial(_rows, keys, even))(table)
        if "distance" in n:
            # A link less may bring them together.
            fits &= values[[r.name for r in _RESULTS].index("fitted_distance")] > radii
        values = np.where(fits, values, np.nan)
        return values, sizes, np.where(fits, Verdict.OK, Verdict.DOES_NOT_FIT).astype(np.uint8)

    return LawOfArrays(judged, lambda element, given: tuple(given(key) for key in keys), _RESULTS)


def pitch_circle(pitch: np.ndarray, teeth: np.ndarray) -> np.ndarray:
    """Diameter of the circle on which the joints of a chain lie, p/sin(π/z)."""
    return pitch / np.sin(math.pi / teeth)


def _links(n: Mapping[str, np.ndarray]) -> np.ndarray:
    """Length of a chain in links, 2a/p + (z₁+z₂)/2 + ((z₂−z₁)/2π)² p/a (ISO 10823)."""
    z1, z2 = n["driving_teeth"], n["driven_teeth"]
    span = n["distance"] / n["pitch"]
    return 2.0 * span + 0.5 * (z1 + z2) + ((z2 - z1) / math.tau) ** 2 / span


def _rows(keys: tuple[str, ...], even: np.ndarray | None, table: np.ndarray) -> np.ndarray:
    n = dict(zip(keys, table, strict=True))
    z1, z2, p, speed = n["driving_teeth"], n["driven_teeth"], n["pitch"], n["speed"]
    d1, d2 = pitch_circle(p, z1), pitch_circle(p, z2)
    missing = np.full_like(p, np.nan)
    links = distance = tension = missing
    mean = np.abs(speed) * z1 * p / math.tau
    if even is not None:
        links = _links(n)
        straight = np.tile(even, p.size // even.size) - 0.5 * (z1 + z2)
        distance = 0.25 * p * (straight + np.sqrt(straight**2 - 8.0 * ((z2 - z1) / math.tau) ** 2))
    if "linear_density" in n:
        tension = n["linear_density"] * mean**2
    return np.stack(
        [
            z2 / z1,
            speed * z1 / z2,
            d1,
            d2,
            mean,
            0.5 * np.abs(speed) * d1,
            2.0 * np.sin(0.5 * math.pi / z1) ** 2,
            0.5 * speed**2 * p,
            2.0 * n["moment"] / d2,
            n["moment"] * z1 / z2,
            links,
            distance,
            tension,
        ]
    )
