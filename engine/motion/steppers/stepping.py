"""A stretch of motion in the energy form: explicit where that is stable, implicit where it isn't."""

import numba
import numpy as np
from numba import types

from engine.compiling.running import prepare, spread
from engine.compiling.tiles import LANES
from engine.motion.moments.at_speed import POLYNOMIAL
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.steppers.energy_form import NEAR_REST, STIFF, Course, Limits, Tables, new_course
from engine.motion.steppers.energy_lanes import carry, new_block_memory
from engine.motion.steppers.places import LOADS, Form

# Where a step times the decay rate of the energy exceeds this, slowing down is the method's doing, not the machine's.
STEEP = 1.0


def advance(
    dynamics: Dynamics,
    variants: Variants,
    tables: Tables,
    energy: np.ndarray,
    limits: Limits,
    record: np.ndarray | None = None,
) -> Course:
    """Carry every variant from its energy at the first node to the end of its stretch.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    tables : Tables
        Of one cycle, over and over again.
    energy : ndarray (variants,)
        [J].
    limits : Limits
    record : ndarray (2, nodes, variants), optional
        Receives energy and time at the nodes.

    Returns
    -------
    Course
    """
    count, channels = variants.count, len(dynamics.channels)
    record = np.empty((2, 0, count)) if record is None else record
    course = new_course(count, channels)
    _carry(False, dynamics, variants, tables, energy, limits, record, course)
    stiff = np.flatnonzero(_is_steep(dynamics, variants, tables, course))
    if stiff.size:
        own, notes = new_course(stiff.size, channels), np.ascontiguousarray(record[:, :, stiff])
        ends = Limits(*(limit[stiff] for limit in limits))
        _carry(True, dynamics, variants.some(stiff), tables.some(stiff), energy[stiff], ends, notes, own)
        record[:, :, stiff] = notes
        for whole, some in zip(course, own, strict=True):
            whole[..., stiff] = some
    return course


def _carry(
    implicit: bool,
    dynamics: Dynamics,
    variants: Variants,
    tables: Tables,
    energy: np.ndarray,
    limits: Limits,
    record: np.ndarray,
    course: Course,
) -> None:
    """Fill record and course; explicitly or implicitly."""
    drive, laws, steps = variants.drive, tables.powers.shape[0], tables.steps.shape[0]
    channels, tables = len(dynamics.channels), Tables(*(np.ascontiguousarray(rows) for rows in tables))
    width = LOADS + POLYNOMIAL + laws + (POLYNOMIAL * channels if channels > 1 else 0)
    form = Form(len(drive.kloss), laws, channels, width)
    given = (implicit, form, tables, drive.rows, drive.exponents, dynamics.channel_of_laws, energy, limits)

    def arguments() -> tuple:
        return (*given, record, course, new_block_memory(form, steps))

    if not carry.overloads:
        prepare(carry, [types.intp, types.intp, *(numba.typeof(argument) for argument in arguments())])
    spread(carry, -(-energy.size // LANES), arguments)


def _is_steep(dynamics: Dynamics, variants: Variants, tables: Tables, course: Course) -> np.ndarray:
    """Which variants stopped because the explicit method is about to become unstable."""
    found = course.stop == STIFF
    doubtful = np.flatnonzero(course.stop == NEAR_REST)
    if doubtful.size:
        part, rows = variants.some(doubtful), tables.some(doubtful)
        k, columns = course.made[doubtful] % rows.steps.shape[0], np.arange(doubtful.size)
        here = rows.at(2 * k, columns)
        omega = np.sqrt(2.0 * course.energy[doubtful] / here.inertia[0])
        slope = dynamics.moments(part, here, omega[None]).slope[0]
        with np.errstate(all="ignore"):
            found[doubtful] = -slope * rows.steps[k, columns] / (here.inertia[0] * omega) > STEEP
    return found
