"""Columns of a machine's outcome, for result files and datasets."""

from collections.abc import Iterable

import numpy as np

from engine import InputUnits
from sweeps.store import POSITION_NAMES, Column, FieldAxis, columns_of_number
from sweeps.study.study_content import ReadyMachine


def position_axis(machine: ReadyMachine) -> FieldAxis:
    """Axis of the fields over a machine's cycle."""
    if InputUnits.of(machine.scene).q == "rad":
        return FieldAxis(POSITION_NAMES[0], "crank angle", "rad", machine.nodes)
    words = "input displacement as a fraction of its range"
    return FieldAxis(POSITION_NAMES[1], words, "1", machine.nodes)


def number_columns(machine: ReadyMachine, summaries: Iterable[str]) -> list[Column]:
    """Columns of verdicts and of some summaries with their error estimates."""
    columns = [
        Column("status", "verdict", "1", dtype=np.uint8),
        Column("status_group", "number of the failing group, element or regime, -1 if none", "1", dtype=np.int16),
        Column("status_at", "input position at which the variant fails", InputUnits.of(machine.scene).q),
    ]
    known = machine.available_summaries
    for name in summaries:
        columns += columns_of_number(name, known[name].long_name, known[name].units)
    return columns


def field_columns(machine: ReadyMachine, fields: Iterable[str]) -> tuple[list[Column], dict[str, FieldAxis]]:
    """Columns of some fields with their error estimates, and axes other than input positions."""
    columns: list[Column] = []
    axes: dict[str, FieldAxis] = {}
    for name in fields:
        quantity, axis = machine.available_fields[name], "position"
        if name in machine.kept_at:
            along, values = machine.kept_at[name]
            axis = along.name
            axes[axis] = FieldAxis(axis, along.long_name, along.units, values)
        if name in machine.fields_with_error:
            words = f"maximum error estimate of: {quantity.long_name}"
            columns.append(Column(f"{name}_error", words, quantity.units))
        columns.append(Column(name, quantity.long_name, quantity.units, ("variant", axis), machine.dtype.type))
    return columns, axes
