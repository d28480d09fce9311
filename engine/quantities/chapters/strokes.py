"""Strokes of sliders and swings of links: their ends, the dead centres, and the quick-return ratio."""

import math
from collections.abc import Callable, Iterable
from functools import partial

import numpy as np

from engine import mechanism
from engine.cycle.measured import Measured
from engine.graph.nodes import Node, reached
from engine.mechanism.mechanics import Mechanics
from engine.parts.skeleton import FRAME
from engine.quantities.expressions import Angle, Expression, Extreme, ExtremePosition, Formula, Integral, StrokeEnd
from engine.quantities.register import Declared, InputUnits, Summary, ranked_summary
from engine.scene import structure
from engine.scene.pairs import held_by_frame


def declare(mechanics: Mechanics) -> Declared:
    """Stroke of every slider, and swing of every link that may swing."""
    k = mechanics.kinematics
    for name in mechanics.structure.sliders:
        slide = k.slides[name]
        yield from _ends(mechanics, name, "stroke", "m", lambda which, s=slide: StrokeEnd(s.d, s.v, which), (slide.d,))
    for name in swinging_links(mechanics):
        end, axis = partial(_swing_end, mechanics, name), k.links[name].u
        yield from _ends(mechanics, name, "swing", "rad", end, (axis.x, axis.y))


def swinging_links(mechanics: Mechanics) -> list[str]:
    """Links that turn at a varying rate, which may swing."""
    zero, links = mechanics.graph.zero, mechanics.kinematics.links
    return [n for n in mechanics.structure.links if links[n].w is not zero and links[n].e is not zero]


def _swing_end(mechanics: Mechanics, name: str, which: str) -> Expression:
    """End of the swing of a link, or the input position there; undefined for a link that turns fully."""
    link = mechanics.kinematics.links[name]
    scene = mechanics.scene
    geared, meshes = name in {*scene.pinions, *scene.inputs}, structure.meshes
    if geared and meshes.root_of(scene, name) == FRAME and meshes.net_turns(scene, name) == 0.0:
        angle = mechanism.higher_pairs.rack_motion.angle_of_link(mechanics.kinematics, name)
        return StrokeEnd(angle, link.w, which)
    angle, sense = Angle(link.u), "least" if which.startswith("low") else "greatest"
    found = ExtremePosition(angle, sense) if which.endswith("_at") else Extreme(angle, sense)
    return Formula(_unless_turning, (found, Integral(link.w))) if mechanics.has_cycle else found


def _unless_turning(value: Measured, turned: Measured) -> Measured:
    turns = np.abs(turned.value) > math.pi
    return Measured(np.where(turns, np.nan, value.value), np.where(turns, np.nan, value.error))


def _ends(
    mechanics: Mechanics, name: str, kind: str, unit: str, end: Callable[[str], Expression], motion: Iterable[Node]
) -> Declared:
    of = f"{'slider' if kind == 'stroke' else 'link'} {name}"
    q = InputUnits.of(mechanics.scene).q
    swings, summary = kind == "swing", ranked_summary(name in held_by_frame(mechanics.scene))
    symbol = "ψ" if swings else "H"
    yield summary(f"{name}.{kind}", f"{kind} of {of}", unit, lambda: end("high") - end("low"), symbol, swings)
    for side in ("low", "high"):
        words = f"{name} {'angle' if swings else 'position'} at the {side} end of its {kind}"
        yield Summary(f"{name}.{kind}_{side}", words, unit, partial(end, side), may_be_undefined=swings)
        words = f"input position at the {side} end of the {kind} of {name}"
        yield Summary(f"{name}.{kind}_{side}_at", words, q, partial(end, f"{side}_at"), may_be_undefined=swings)
    # The motion has to repeat with each turn of the crank, not only with the cycle.
    if mechanics.has_cycle and (mechanics.scene.input.revolutions == 1 or mechanics.graph.q not in reached(motion)):
        words = f"quick-return ratio of the {kind} of {name}"
        ratio = partial(_time_ratio, end)
        yield summary(f"{name}.{kind}_time_ratio", words, "1", ratio, "K", True)


def _time_ratio(end: Callable[[str], Expression]) -> Expression:
    return Formula(quick_return_ratio, (end("low_at"), end("high_at")))


def quick_return_ratio(low_at: Measured, high_at: Measured) -> Measured:
    """Crank angle of the slow stroke over that of the fast one, R = α/(2π − α), at least 1.

    Undefined if its error reaches its value: where two positions tie for an end of the stroke, either may be the end.
    """
    up = np.mod(high_at.value - low_at.value, math.tau)
    slow = np.maximum(up, math.tau - up)
    ratio = slow / (math.tau - slow)
    # R(α + dα) − R(α), not linearised: where positions tie, dα is large.
    off = low_at.error + high_at.error
    error = math.tau * off / ((math.tau - slow) * (math.tau - slow - off))
    unknown = ~((error < ratio) & (slow + off < math.tau))
    return Measured(np.where(unknown, np.nan, ratio), np.where(unknown, np.nan, error))
