"""Motion curves and outlines of a cam as a table."""

from pathlib import Path

import numpy as np

from engine import CamElement, cam_curves
from sweeps.report.files.exports import write_columns
from sweeps.text.input_files import InputError


def cam_csv(cam: CamElement, out: Path, points: int) -> None:
    """Motion, pressure angle, curvature, forces and outlines of a cam over its turn as CSV, in SI units.

    At a jump of a law its angle has two rows.

    Parameters
    ----------
    cam : CamElement
    out : Path
    points : int
        Approximate number of rows.

    Raises
    ------
    InputError
        The follower doesn't reach the base circle, or the file can't be written.
    """
    c = cam_curves(cam, points)
    if not c.angle.size:
        message = "is too small: the follower doesn't reach the base circle; enlarge it"
        raise InputError(out.stem, [(None, "base_radius", message)])
    stroke = "m" if cam.translating else "rad"
    columns = {
        "angle [rad]": c.angle,
        f"displacement [{stroke}]": c.displacement,
        f"displacement_phi [{stroke}]": c.first,
        f"displacement_phiphi [{stroke}]": c.second,
        f"displacement_phiphiphi [{stroke}]": c.third,
        "pressure_angle [rad]": c.pressure_angle,
        "curvature [m-1]": c.curvature,
    }
    if cam.follower.moved is not None:
        columns |= {"contact_force [N]": c.force, "moment [N m]": c.moment}
    for name, line in (("profile", c.profile), ("pitch", c.pitch), ("cutter", c.cutter)):
        columns |= {f"{name}_x [m]": line.real, f"{name}_y [m]": line.imag}
    rows = np.array([*columns.values()])
    # Adjacent pieces without a jump share a row; rounding duplicates it.
    scale = np.abs(rows).max(axis=1, where=np.isfinite(rows), initial=0.0)
    with np.errstate(invalid="ignore"):
        same = (np.abs(np.diff(rows)) <= 1e-12 * scale[:, None]).all(axis=0)
    write_columns(out, columns, np.append(True, ~same))
