"""Positions and fields of one machine over its cycle, closed by the first position, for diagrams."""

import math
from collections.abc import Sequence

import numpy as np

import engine
from sweeps.pictures.picture_error import PictureError

# Larger values overflow an axis.
LARGEST = 1e300


def need_motion(moving: engine.MovingMachine, names: Sequence[str]) -> None:
    """Raise a `PictureError` if fields of a machine can't be computed."""
    verdict = moving.verdict(names)
    if verdict not in (engine.Verdict.OK, engine.Verdict.NOT_FINITE):
        raise PictureError(f"no diagrams of this machine: {verdict.sentence}")


def input_axis(scene: engine.Scene) -> engine.PanelAxis:
    """Axis of the input's position."""
    units = engine.InputUnits.of(scene)
    words = "crank angle" if isinstance(scene.input, engine.CrankInput) else f"displacement of {scene.input.link}"
    return engine.PanelAxis(words, units.q, units.symbols[0])


def closed(scene: engine.Scene, row: np.ndarray, turned: float = 0.0) -> np.ndarray:
    """A row over the positions; that of a cycle ends with its first value, increased by `turned`."""
    return np.append(row, row[:1] + turned) if scene.has_cycle else row


def panel_over_cycle(
    moving: engine.MovingMachine,
    axis: engine.PanelAxis,
    curves: Sequence[engine.Curve],
    marks: Sequence[engine.Mark] = (),
    title: str = "",
) -> engine.Panel:
    """A diagram of closed rows over the input's position."""
    q = moving.q
    places = closed(moving.scene, q, 2.0 * q[-1] - q[-2] - q[0])
    return engine.Panel(input_axis(moving.scene), axis, places, curves, marks, title)


def over_cycle(moving: engine.MovingMachine, names: Sequence[str]) -> dict[str, np.ndarray]:
    """Closed rows of fields without rounding; an angle may end whole turns further."""
    known = moving.register.fields
    return {
        name: closed(moving.scene, row, _turned(row) if known[name].units == "rad" else 0.0)
        for name, own in moving.fields(dict.fromkeys(names)).items()
        for row in [moving.without_rounding(name, own)]
    }


def _turned(row: np.ndarray) -> float:
    """Increase of an angle over the cycle: a whole number of turns."""
    increase = row[-1] + (row[1] - row[0]) - row[0]
    return math.tau * round(increase / math.tau) if math.isfinite(increase) else 0.0


def dead_centres(moving: engine.MovingMachine, slider: str | None) -> list[engine.Mark]:
    """Marks at the dead centres of a slider over a cycle."""
    if slider is None or not moving.scene.has_cycle:
        return []
    ends = (moving.summary(f"{slider}.stroke_{end}_at") % math.tau for end in ("low", "high"))
    # A piston has them in every turn.
    is_piston = any(cylinder.piston == slider for cylinder in moving.scene.cylinders.values())
    turns = range(moving.scene.input.revolutions if is_piston else 1)
    return [engine.Mark("", end + math.tau * turn, None) for end in ends if math.isfinite(end) for turn in turns]
