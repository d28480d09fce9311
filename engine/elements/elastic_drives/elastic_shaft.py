"""The elastic shaft of a drive, for elements: keys, stiffness and damping."""

from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.elements.compliances.reduction import in_series, reduced_part
from engine.elements.compliances.stiffnesses import damping_of_absorption
from engine.elements.element import Numbers
from engine.parts.actions import TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Name, Number, Part


class ElasticShaft(Part):
    """An elastic shaft, with its stiffness given directly or by its parts in series."""

    one_of: ClassVar = (("stiffness", "parts"),)
    at_most_one_of: ClassVar = (("damping", "damping_ratio"),)

    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    damping_ratio: Annotated[Number, Field(ge=0)] | None = None


class DriveShaft(NamedTuple):
    """Stiffness [N·m/rad] and damping [N·m·s/rad] of a drive's shaft, and natural frequency in contact [rad/s]."""

    stiffness: np.ndarray
    damping: np.ndarray
    frequency: np.ndarray


def drive_shaft(drive: ElasticShaft, n: Numbers) -> DriveShaft:
    """The shaft of a drive, with all dampers evaluated at its natural frequency.

    Parameters
    ----------
    drive : ElasticShaft
        Defines which keys are given; its own values are not used.
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, and the inertias at its ends, "motor_inertia" and "load_inertia".
    """
    absorption = np.zeros_like(n["motor_inertia"])
    if drive.parts is None:
        stiffness, damping = n["stiffness"], n.get("damping", absorption)
    else:
        whole = in_series({name: reduced_part(part, n, f"parts.{name}") for name, part in drive.parts.items()})
        stiffness, damping, absorption = whole.stiffness, whole.damping, whole.absorption
        damping = damping + n.get("damping", 0.0)
    frequency = np.sqrt(stiffness * (1.0 / n["motor_inertia"] + 1.0 / n["load_inertia"]))
    damping = damping + damping_of_absorption(absorption, stiffness, frequency)
    if drive.damping_ratio is not None:
        damping = damping + 2.0 * n["damping_ratio"] * stiffness / frequency
    return DriveShaft(stiffness, damping, frequency)
