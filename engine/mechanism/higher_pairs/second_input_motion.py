"""Second inputs as nodes: links moved by laws of the first input or of time.

The argument τ of a law is proportional to the input's coordinate q, τ = κ q. At constant input speed ω, t = q/ω, so a
law with period T is a law of q with κ = 2π/(ω T). By any parameter, such as q or the time of a true motion,

    ψ′ = τ′ dψ/dτ,    ψ″ = τ′² d²ψ/dτ² + τ″ dψ/dτ
"""

import math

import numpy as np

from engine.graph.nodes import Node
from engine.laws.elementary import direction_of
from engine.laws.kinematics.law_harmonics import law_harmonic
from engine.mechanism.assembly import Assembly, Slide, Turning
from engine.mechanism.higher_pairs.motion_program import Turned, add_program, turns_of_input
from engine.mechanism.vectors import Vector
from engine.scene.pairs import drive_base
from engine.scene.structure.input_laws import law_rate

Law = tuple[Node, Node, Node]


def add_second_input(assembly: Assembly, name: str) -> None:
    """Add the second input `name` to a mechanism."""
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
    assembly.link(name, Turning(assembly.points[second.pivot], u.to_frame(base.u), base.w + w, base.e + e))


def rate_of_drive(assembly: Assembly, name: str) -> Node:
    """Rate of the second input `name` relative to the base of its drive, with respect to the first input."""
    if name in assembly.slides:
        return assembly.slides[name].v
    return assembly.links[name].w - assembly.links[drive_base(assembly.scene, name)].w


def _law(assembly: Assembly, name: str) -> Law:
    """Angle or position of a second input by its law, and two derivatives with respect to the input."""
    second, graph, at = assembly.scene.inputs[name], assembly.graph, f"inputs.{name}"
    argument, rate, growth = _argument(assembly, name)
    if second.type == "slider":
        law = assembly.number(f"{at}.start"), graph.zero, graph.zero
    else:
        ratio = assembly.number(f"{at}.ratio")
        law = ratio * argument + assembly.number(f"{at}.phase"), ratio, graph.zero
    for key, harmonic in second.harmonics.items():
        amplitudes = (assembly.number(f"{at}.harmonics.{key}.{part}") for part in ("cosine", "sine"))
        law = _sum(law, graph.apply(law_harmonic, argument, float(harmonic.order), *amplitudes))
    if second.sections or second.table is not None:
        lag = graph.derived(f"begin of {name}", lambda n: np.mod(n[f"{at}.begin"], math.tau))
        turns = turns_of_input(assembly.scene.input, law_rate(assembly.scene, name))
        law = _sum(law, add_program(graph, second, at, Turned(argument - lag, rate, turns)))
        if second.advance:
            # The program starts at `begin` itself, not at the same place of the first turn.
            before = graph.derived(f"turns before begin of {name}", lambda n: n[f"{at}.begin"] // math.tau)
            law = law[0] - second.advance * before, *law[1:]
    place, slope, bend = law[0], rate * law[1], (rate * rate) * law[2] + growth * law[1]
    if getattr(second, "speed", 0.0) != 0.0:
        clock, even = assembly.course.clock, assembly.number(f"{at}.speed")
        if clock is None:
            even = graph.derived(f"even rate of {name}", lambda n: n[f"{at}.speed"] / n["input.speed"])
            return place + even * graph.q, slope + even, bend
        place, slope = place + even * clock, slope + even * assembly.course.pace
    return place, slope, bend


def _argument(assembly: Assembly, name: str) -> Law:
    """Argument τ of a second input's law, and its first two derivatives by the parameter of the motion."""
    second, course, graph = assembly.scene.inputs[name], assembly.course, assembly.graph
    if second.period is not None and course.clock is not None:
        rate = graph.derived(f"rate of {name} over time", lambda n: math.tau / n[f"inputs.{name}.period"])
        return rate * course.clock, rate * course.pace, graph.zero
    rate = _rate(assembly, name)
    if not course.follows:
        return rate * graph.q, graph.zero, graph.zero
    return rate * graph.q, rate * course.first, rate * course.second


def _rate(assembly: Assembly, name: str) -> Node:
    """κ: rate of the argument of a second input's law with respect to the first input."""
    second, graph, at = assembly.scene.inputs[name], assembly.graph, f"inputs.{name}"
    if second.period is not None:
        return graph.derived(f"rate of {name}", lambda n: math.tau / (n["input.speed"] * n[f"{at}.period"]))
    if second.travel is not None:
        return graph.derived(f"rate of {name}", lambda n: math.tau / n[f"{at}.travel"])
    return graph.one


def _sum(one: Law, other: Law) -> Law:
    return tuple(a + b for a, b in zip(one, other, strict=True))
