"""Motion curves and outlines of a cam as a table."""

import numpy as np

from engine import CamCurves, CamElement
from sweeps.report.files.data_files import DataTable


def cam_table(cam: CamElement, c: CamCurves) -> DataTable:
    """Motion, pressure angle, curvature, forces and outlines of a cam over its turn.

    At a jump of a law its angle has two rows.

    Parameters
    ----------
    cam : CamElement
    c : CamCurves
        Its curves.
    """
    stroke = "m" if cam.translating else "rad"
    columns = {
        "angle": (c.angle, "rad"),
        "displacement": (c.displacement, stroke),
        "displacement_phi": (c.first, f"{stroke} rad-1"),
        "displacement_phiphi": (c.second, f"{stroke} rad-2"),
        "displacement_phiphiphi": (c.third, f"{stroke} rad-3"),
        "pressure_angle": (c.pressure_angle, "rad"),
        "curvature": (c.curvature, "m-1"),
    }
    if cam.follower.moved is not None:
        columns |= {"contact_force": (c.force, "N"), "moment": (c.moment, "N m")}
    for name, line in (("profile", c.profile), ("pitch", c.pitch), ("cutter", c.cutter)):
        columns |= {f"{name}_x": (line.real, "m"), f"{name}_y": (line.imag, "m")}
    rows = np.array([row for row, _ in columns.values()])
    # Adjacent pieces without a jump share a row; rounding duplicates it.
    scale = np.abs(rows).max(axis=1, where=np.isfinite(rows), initial=0.0)
    with np.errstate(invalid="ignore"):
        same = (np.abs(np.diff(rows)) <= 1e-12 * scale[:, None]).all(axis=0)
    kept, units = rows[:, np.append(True, ~same)], {name: unit for name, (_, unit) in columns.items()}
    return DataTable.whole(dict(zip(columns, kept, strict=True)), units)
