"""Second inputs, put together from nodes: links that their own drives turn or slide by laws of the crank's angle."""

import numpy as np

from engine.graph.nodes import Node
from engine.laws.elementary import direction_of
from engine.laws.kinematics.law_harmonics import law_harmonic
from engine.mechanism.assembly import Assembly, Slide, Turning
from engine.mechanism.higher_pairs.motion_program import TURN, add_program, turns_of_input
from engine.mechanism.vectors import Vector
from engine.scene.pairs import drive_base

Law = tuple[Node, Node, Node]


def add_second_input(assembly: Assembly, name: str) -> None:
    """Add a second input to a mechanism.

    Parameters
    ----------
    assembly : Assembly
    name : str
        Of the link.
    """
    second = assembly.scene.inputs[name]
    law = _law(assembly, name)
    if second.type == "slider":
        slide, line = Slide(*law), assembly.guides[second.guide]
        assembly.slider(name, line.along(slide), line, slide)
        return
    angle, w, e = law
    assembly.turned[name] = angle
    base_name = drive_base(assembly.scene, name)
    base, u = assembly.links[base_name], Vector(*assembly.graph.apply(direction_of, angle))
    assembly.link(name, Turning(assembly.points[second.pivot], u.in_axes(base.u), base.w + w, base.e + e))


def rate_of_drive(assembly: Assembly, name: str) -> Node:
    """Motion of a second input against what its drive stands on, for each unit of the crank's.

    Parameters
    ----------
    assembly : Assembly
    name : str
        Of the link.
    """
    if name in assembly.slides:
        return assembly.slides[name].v
    return assembly.links[name].w - assembly.links[drive_base(assembly.scene, name)].w


def _law(assembly: Assembly, name: str) -> Law:
    """Angle or place of a second input by its law, and two derivatives by the crank's angle."""
    second, graph, at = assembly.scene.inputs[name], assembly.graph, f"inputs.{name}"
    if second.type == "slider":
        law = assembly.number(f"{at}.start"), graph.zero, graph.zero
    else:
        ratio = assembly.number(f"{at}.ratio")
        law = ratio * graph.q + assembly.number(f"{at}.phase"), ratio, graph.zero
    for key, harmonic in second.harmonics.items():
        amplitudes = (assembly.number(f"{at}.harmonics.{key}.{part}") for part in ("cosine", "sine"))
        law = _sum(law, graph.apply(law_harmonic, graph.q, float(harmonic.order), *amplitudes))
    if second.sections or second.table is not None:
        lag = graph.derived(f"begin of {name}", lambda n: np.mod(n[f"{at}.begin"], TURN))
        turns = turns_of_input(assembly.scene.input, 1.0)
        law = _sum(law, add_program(graph, second, at, graph.q - lag, turns))
    return law


def _sum(one: Law, other: Law) -> Law:
    return tuple(a + b for a, b in zip(one, other, strict=True))
