"""The motion program of a cam or a second input as nodes: displacement over an angle, and its derivatives.

A program stays on one section, or one piece of its table, throughout a panel: that in the panel's middle. Panels end at
the boundaries of sections and of the expressions of their laws.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Graph, Node, Number
from engine.laws.cams.motion_laws import DWELL, LAW_BREAKS, LAW_KINDS, MOTIONS, motion_if, section_at
from engine.laws.tables import in_memory, make_table, periods_before, table_segment
from engine.parts.motion_programs import DwellSection, MotionProgram, Sections, sections_of
from engine.parts.skeleton import CrankInput, SliderInput
from engine.scene.scene import Numbers

_PARTS = ("begin", "angle", "before", "stroke")


class Displacement(NamedTuple):
    """Displacement [m or rad] and its first two derivatives with respect to the driving angle."""

    s: Node
    s1: Node
    s2: Node


class Turned(NamedTuple):
    """Abscissa of a motion program.

    Attributes
    ----------
    angle : Node
        Angle of the cam or crank from the start of the first section [rad].
    rate : Node
        Derivative of the angle with respect to the input.
    turns : range
        Turns, counted from there, that the input's range covers.
    """

    angle: Node
    rate: Node
    turns: range


def add_program(graph: Graph, program: MotionProgram, at: str, turned: Turned) -> Displacement:
    """Displacement of a motion program.

    Parameters
    ----------
    graph : Graph
    program : MotionProgram
    at : str
        Path of the program in the scene.
    turned : Turned
    """
    if program.table is not None:
        return _tabled(graph, program, turned)
    return _by_sections(graph, program, at, turned)


def turns_of_input(drive: CrankInput | SliderInput, rate: float) -> range:
    """Turns that the input's range covers, of an angle that changes at `rate` and started at most a turn later.

    Parameters
    ----------
    drive : CrankInput or SliderInput
    rate : float
        [rad per rad, or per m of a sliding input]
    """
    ends = (0.0, math.tau * drive.revolutions) if drive.turns_fully else (drive.start, drive.stop)
    first, last = sorted(rate * end for end in ends)
    return range(math.floor(first / math.tau) - 1, math.ceil(last / math.tau + 1e-9) + 1)


def _by_sections(graph: Graph, program: MotionProgram, at: str, turned: Turned) -> Displacement:
    laws = [DWELL if isinstance(s, DwellSection) else LAW_KINDS[s.law] for s in program.sections.values()]

    def number(k: int, part: str) -> Number:
        return graph.derived(f"{at} section {k} {part}", lambda n: getattr(_of_a_turn(program, at, n), part)[k])

    rows: list[Number] = []
    for k, law in enumerate(laws):
        rows += [number(k, part) for part in _PARTS]
        rows.append(graph.derived(f"{at} section {k} law", lambda n, law=law: float(law)))
        for inside in (0.0, *LAW_BREAKS.get(law, ())):
            for turn in turned.turns:
                graph.switches(turned.angle, turned.rate, _level(graph, program, at, (k, inside, turn)))
    table = graph.number_table(f"{at} sections", rows)
    begin, angle, before, stroke, kind = (
        graph.held(part) for part in graph.apply(section_at, table, float(len(laws)), turned.angle)
    )
    u, rate = (turned.angle - begin) / angle, graph.one / angle
    motions = {
        law: graph.apply(MOTIONS[law], *((u, graph.held(u)) if law in LAW_BREAKS else (u,)))
        for law in dict.fromkeys(laws)
    }
    _, motion = motions.popitem()
    for law, own in motions.items():
        motion = graph.apply(motion_if, kind, float(law), own, motion)
    shape, slope, bend, _ = motion
    if program.advance:
        gone = graph.held(graph.apply(periods_before, 0.0, math.tau, turned.angle))
        before = before + (program.advance / math.tau) * gone
    return Displacement(before + stroke * shape, stroke * rate * slope, stroke * (rate * rate) * bend)


def _of_a_turn(program: MotionProgram, at: str, numbers: Numbers) -> Sections:
    """Sections of a program; their angles are NaN unless they add up to a turn."""
    found = sections_of(program, f"{at}.", numbers)
    return found._replace(angle=[np.where(found.whole, angle, np.nan) for angle in found.angle])


def _level(graph: Graph, program: MotionProgram, at: str, place: tuple[int, float, int]) -> Number:
    """Angle at which a section, or an expression of its law, starts in one of the turns."""
    k, inside, turn = place

    def angle(numbers: Numbers) -> float | np.ndarray:
        found = _of_a_turn(program, at, numbers)
        return found.begin[k] + inside * found.angle[k] + math.tau * turn

    return graph.derived(f"{at} section {k} at {inside} in turn {turn}", angle)


def _tabled(graph: Graph, program: MotionProgram, turned: Turned) -> Displacement:
    motion = program.table
    table = make_table(motion.over_angle, motion.rows, motion.interpolation, math.tau)
    for row in table.breaks[:-1]:
        for turn in turned.turns:
            graph.switches(turned.angle, turned.rate, graph.constant(row + math.tau * turn))
    offset = graph.store(in_memory(table))
    left, c3, c2, c1, c0 = (graph.held(part) for part in graph.apply(table_segment, graph.memory, offset, turned.angle))
    t = turned.angle - left
    return Displacement(((c3 * t + c2) * t + c1) * t + c0, (3.0 * c3 * t + 2.0 * c2) * t + c1, 6.0 * c3 * t + 2.0 * c2)
