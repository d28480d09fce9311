"""Cylinders: pressure and volume, indicated work and power, delivery.

Sources: J. B. Heywood, Internal Combustion Engine Fundamentals, section 2.3 (indicated work, mean effective pressure);
any textbook of reciprocating compressors (volumetric efficiency of the polytropic diagram with clearance).
"""

from engine.graph.nodes import Node
from engine.laws.senses import exceeds
from engine.mechanism.actions.cylinders import Diagram, piston_area
from engine.mechanism.mechanics import Mechanics
from engine.parts.cylinders import EngineCylinder, FourStroke, Pump
from engine.quantities.expressions import Expression, Integral, StrokeEnd, VariantNumber, length_of_range
from engine.quantities.register import Declared, Field, Summary, answer_summary, ranked_summary
from engine.words.quantity import called


def declare(mechanics: Mechanics) -> Declared:
    """Pressure and volume of every cylinder; over a cycle, indicated work and power, and delivery."""
    for name in mechanics.scene.cylinders:
        yield from _of_cylinder(mechanics, name)


def _of_cylinder(m: Mechanics, name: str) -> Declared:
    graph, cylinder, at = m.graph, m.scene.cylinders[name], f"cylinders.{name}"
    area = graph.derived(f"{at}.piston area", lambda n: piston_area(n[f"{at}.bore"]))

    def diagram() -> Diagram:
        return Diagram(m.kinematics, name)

    def volume() -> Node:
        seen, clearance = diagram(), graph.zero if isinstance(cylinder, Pump) else graph.number(f"{at}.clearance")
        return area * (seen.travel + clearance * seen.stroke)

    words = f"absolute pressure in {called('cylinder', name)}"
    yield Field(f"{name}.pressure", words, "Pa", lambda: diagram().pressure, "p")
    yield Field(f"{name}.volume", f"volume of {called('cylinder', name)}", "m3", volume, "V")

    def swept() -> Expression:
        slide = m.kinematics.slides[cylinder.piston]
        low, high = (StrokeEnd(slide.d, slide.v, which) for which in ("low", "high"))
        return VariantNumber(area) * (high - low)

    words = f"swept volume of {called('cylinder', name)}"
    yield answer_summary(f"{name}.swept_volume", words, "m3", swept, "V_s")
    if not m.has_cycle:
        return
    engine = isinstance(cylinder, EngineCylinder)

    def work() -> Expression:
        """∮ p dV: work of the gas in an engine, work on the gas or liquid in other machines."""
        done = Integral(diagram().pressure * (area * diagram().rate))
        return done if engine else -done

    def per_second(of_cycle: Expression) -> Expression:
        return of_cycle * abs(VariantNumber(m.speed)) / length_of_range(m.first, m.last)

    whose = "of the gas" if engine else f"on the {'liquid' if isinstance(cylinder, Pump) else 'gas'}"
    words = f"indicated work {whose} in {called('cylinder', name)}"
    yield Summary(f"{name}.indicated_work", f"{words} per cycle of the machine", "J", work, "W_i")
    words = f"indicated power {whose} in {called('cylinder', name)}"
    yield answer_summary(f"{name}.indicated_power", words, "W", lambda: per_second(work()), "P_i")
    # Gas cycles per machine cycle.
    times = m.scene.input.revolutions / (2.0 if isinstance(cylinder, FourStroke) else 1.0)
    if not isinstance(cylinder, Pump):
        words, summary = f"indicated mean effective pressure of {called('cylinder', name)}", ranked_summary(engine)
        yield summary(f"{name}.mean_effective_pressure", words, "Pa", lambda: work() / (swept() * times), "p_mi")
    if engine:
        return

    def drawn() -> Expression:
        return Integral(diagram().flows_in * (area * diagram().rate))

    def displaced() -> Expression:
        return Integral(graph.held(graph.apply(exceeds, diagram().rate, 0.0)) * (area * diagram().rate))

    words = f"volume that {called('cylinder', name)} delivers per time, at suction"
    yield answer_summary(f"{name}.delivery", words, "m3 s-1", lambda: per_second(drawn()), "Q")
    if not isinstance(cylinder, Pump):
        words = f"volumetric efficiency of {called('cylinder', name)}: volume drawn in over volume displaced"
        yield answer_summary(f"{name}.volumetric_efficiency", words, "1", lambda: drawn() / displaced(), "η_v")
