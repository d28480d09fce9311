"""What is computed of friction wheels: creep, the force that has to press them together, whether they slide."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges
from engine.elements.gears.drive_elements import FrictionDrive
from engine.verdicts import Verdict

_RESULTS = (
    ElementResult("ratio", "speed of the driving wheel over that of the driven one", "1"),
    ElementResult("driven_speed", "angular speed of the driven wheel", "rad s-1"),
    ElementResult("tangential_force", "force along the rims", "N"),
    ElementResult("needed_press_force", "force that has to press the wheels together", "N"),
    ElementResult("traction_share", "force along the rims over the greatest that friction allows", "1", "press_force"),
    ElementResult("driving_moment", "moment that drives", "N m"),
    ElementResult("input_power", "power put in", "W"),
    ElementResult("efficiency", "power that comes out over power put in, creep alone lost", "1"),
)


def friction_drive_law(drive: FrictionDrive) -> LawOfArrays:
    """The law of friction wheels: verdicts where less presses them than just suffices, and on rings that are too small.

    Parameters
    ----------
    drive : FrictionDrive
    """
    keys = ("driving_diameter", "driven_diameter", "friction", "creep", "safety", "speed", "moment")
    keys += tuple(key for key in ("groove_angle", "press_force") if getattr(drive, key) is not None)

    def judged(table: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        values, sizes = with_nudges(partial(_rows, drive, keys))(table)
        slides = values[[r.name for r in _RESULTS].index("traction_share")] >= 1.0
        hidden = np.where(slides, np.nan, 1.0)
        # What the wheels would need is still told.
        told = [r.name in ("tangential_force", "needed_press_force", "traction_share") for r in _RESULTS]
        values = np.where(np.array(told)[:, None], values, values * hidden)
        status = np.where(slides, Verdict.SLIDES, Verdict.OK)
        if drive.internal:
            driving, driven = (table[keys.index(key)] for key in ("driving_diameter", "driven_diameter"))
            values = np.where(driven > driving, values, np.nan)
            status = np.where(driven > driving, status, Verdict.DOES_NOT_FIT)
        return values, sizes, status.astype(np.uint8)

    return LawOfArrays(judged, lambda element, given: tuple(given(key) for key in keys), _RESULTS)


def _rows(drive: FrictionDrive, keys: tuple[str, ...], table: np.ndarray) -> np.ndarray:
    n: Mapping[str, np.ndarray] = dict(zip(keys, table, strict=True))
    # In a groove the faces press with 1/sin of half its angle.
    mu = n["friction"] / np.sin(0.5 * n["groove_angle"]) if "groove_angle" in n else n["friction"]
    ratio = (1.0 if drive.internal else -1.0) * n["driven_diameter"] / (n["driving_diameter"] * (1.0 - n["creep"]))
    pull = 2.0 * n["moment"] / n["driven_diameter"]
    driving = 0.5 * pull * n["driving_diameter"]
    share = pull / (mu * n["press_force"]) if "press_force" in n else np.full_like(pull, np.nan)
    return np.stack(
        [
            ratio,
            n["speed"] / ratio,
            pull,
            n["safety"] * pull / mu,
            share,
            driving,
            driving * np.abs(n["speed"]),
            1.0 - n["creep"],
        ]
    )
