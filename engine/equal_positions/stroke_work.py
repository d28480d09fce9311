"""Work of a force that is given over a slider's stroke: exact between positions, however it jumps.

Such a force depends on the slider's coordinate alone, so its work between two positions is a difference of the
integral of its table, whatever lies between them. Where the slider turns back in between, and the force acts one way
only, the dead centre parts the two.
"""

import numpy as np

from engine.compiling.jit import scalar
from engine.equal_positions.strokes import extreme_between
from engine.equal_positions.text.program import Program
from engine.laws.loads import acts_in_direction
from engine.laws.tables import integral_near, table_integral
from engine.machine.mechanism import Mechanism
from engine.scene.actions import TableForce
from engine.scene.pairs import holder_of
from engine.scene.parts import FRAME, Sliding, Yoke
from engine.scene.scene import Scene


@scalar
def work_over_stroke(
    d: np.ndarray,
    v: np.ndarray,
    h: float,
    forward: float,
    cosine: float,
    direction: float,
    origin: float,
    sense: float,
    breaks: np.ndarray,
    coefficients: np.ndarray,
    work: np.ndarray,
) -> float:
    """Work of a force over a periodic stroke, from the first position to each, into `work`; returns that of a cycle.

    Parameters
    ----------
    d, v : ndarray (positions,)
        Slider's coordinate and its derivative by q.
    h : float
        Spacing of the positions.
    forward : float
        Sign of the input's speed.
    cosine : float
        Of the angle from the way of rising d to the force.
    direction : float
        +1 where the force acts only while its point moves along it, −1 only against it, 0 always.
    origin, sense : float
        The table is over origin + sense·d, sense +1 or −1.
    breaks, coefficients : ndarray
        Of the table's integral, `engine.laws.tables.integrated`.
    work : ndarray (positions,)
        Receives the work over the cycle's positions.
    """
    n = d.shape[0]
    total, way, last, piece, known = 0.0, forward * cosine, 0.0, 0, False
    for k in range(n):
        work[k] = total
        after = k + 1 if k + 1 < n else 0
        here, there = acts_in_direction(direction, v[k] * way), acts_in_direction(direction, v[after] * way)
        if here == 0.0 and there == 0.0:
            known = False
            continue
        if not known:
            last, piece = integral_near(breaks, coefficients, origin + sense * d[k], piece)
        reached, piece = integral_near(breaks, coefficients, origin + sense * d[after], piece)
        if (v[k] > 0.0) != (v[after] > 0.0):
            end = extreme_between(d[k], d[after], v[k], v[after], h)[1]
            turned = table_integral(breaks, coefficients, origin + sense * end)
            total += sense * cosine * (here * (turned - last) + there * (reached - turned))
        else:
            total += sense * cosine * (here if v[k] != 0.0 else there) * (reached - last)
        last, known = reached, True
    return total


def frame_guide(scene: Scene, slider: str) -> str | None:
    """Guide on the frame on which a slider of a group moves; None where it slides on something that moves."""
    for group in scene.groups.values():
        for part in (group.first, group.second):
            if part.link == slider and isinstance(part, (Sliding, Yoke)) and scene.guides[part.guide].link == FRAME:
                return part.guide
    return None


def work_call(scene: Scene, mechanism: Mechanism, program: Program, name: str, forward: str) -> str | None:
    """Call of `work_over_stroke` for a force; None where its work isn't a matter of its slider's stroke alone.

    Parameters
    ----------
    scene, mechanism, program
    name : str
        Of the force. Its table's integral is the table NAME__work.
    forward : str
        Variable of the sign of the input's speed.

    Returns
    -------
    str or None
        With `$` behind everything that depends on how many positions there are; it fills the row pot__NAME$.
    """
    force = scene.forces.get(name)
    if not isinstance(force, TableForce) or force.over_stroke is None:
        return None
    guide = frame_guide(scene, force.slider)
    if guide is None or force.angle is None or force.turns_with != FRAME or holder_of(scene, force.on) != force.slider:
        return None
    way, along = f"forces.{name}.angle", f"guides.{guide}.angle"
    cosine = program.derived(f"{way}.along", lambda n: np.cos(n[way] - n[along]))
    direction = {"always": "zero", "along": "one", "against": "-one"}[force.acts]
    slide, table = mechanism.slides[force.slider], f"table__{name}__work"
    origin, sense = {
        "guide": ("zero", "one"),
        "low end": (f"-low__{force.slider}$", "one"),
        "high end": (f"high__{force.slider}$", "-one"),
    }[force.measured_from]
    given = f"row__{slide.d}$, row__{slide.dv}$, h$, {forward}, {cosine}, {direction}, {origin}, {sense}"
    return f"work_over_stroke({given}, {table}_breaks, {table}_coefficients, pot__{name}$)"
