"""Manufacturing tolerances of a study."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine import AskError, Scene, in_text, scene_numbers, unknown_name_message
from sweeps.study.study_text import ToleranceText


class Tolerance(NamedTuple):
    """Tolerance of a number: uniform within ± `half_width`, or normal with σ = ±/3."""

    path: str
    half_width: float
    distribution: str

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return self.half_width / (3.0 if self.distribution == "normal" else 3.0**0.5)


def read_tolerances(scene: Scene, texts: Mapping[str, ToleranceText]) -> tuple[Tolerance, ...]:
    """Tolerances in SI units.

    Parameters
    ----------
    scene : Scene
    texts : mapping of str to ToleranceText
        By path of the number.

    Raises
    ------
    AskError, UnitError
        No number of the scene, or no width.
    """
    numbers, found = scene_numbers(scene), []
    for path, text in texts.items():
        if path not in numbers:
            raise AskError(unknown_name_message(path, numbers, "is not a number that the scene gives"))
        half_width = in_text(text.plus_minus, numbers[path].dimension)
        if not 0 < half_width < np.inf:
            raise AskError(f"{text.plus_minus!r}: a tolerance must be greater than 0, such as '0.1 mm'")
        found.append(Tolerance(path, half_width, text.distribution))
    return tuple(found)
