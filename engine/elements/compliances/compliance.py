"""Elastic parts of a drive in series: stiffness and damping reduced to one shaft, and the contribution of each part."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.elements.compliances.reduction import in_series, reduced_part
from engine.elements.compliances.stiffnesses import damping_of_absorption
from engine.elements.element import Element, NamedRows, Numbers
from engine.elements.panels import Curve, Panel, PanelAxis
from engine.parts.skeleton import Moment, Name, quantity
from engine.units.display import quantity_text
from engine.words.quantity import main_result


class ComplianceElement(Element):
    """Parts of a drive in series, reduced to one shaft, relative to which the parts' speed ratios are defined.

    A `moment` on that shaft gives the moment and twist of every part; the `frequency` of a vibration relates energy
    absorption and damping.
    """

    picture: ClassVar = "shares"
    type: Literal["compliance"]
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)]
    moment: Annotated[Moment, Field(gt=0)] | None = None
    frequency: Annotated[quantity("angular_speed"), Field(gt=0)] | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of the whole and of every part."""
        whole = in_series({name: reduced_part(part, n, f"parts.{name}") for name, part in self.parts.items()})
        damping, absorption = None, whole.absorption
        if self.frequency is not None:
            damping = whole.damping + damping_of_absorption(whole.absorption, whole.stiffness, n["frequency"])
            absorption = damping * math.tau * n["frequency"] / whole.stiffness
        yield main_result("stiffness", "torsional stiffness of all parts, reduced", "N m rad-1"), whole.stiffness
        words = "torsional compliance of all parts, reduced"
        yield main_result("compliance", words, "rad N-1 m-1"), 1.0 / whole.stiffness
        yield main_result("energy_absorption", "energy absorption of all parts", "1"), absorption
        if damping is not None:
            yield main_result("damping", "torsional damping of all parts, reduced", "N m s rad-1"), damping
        if self.moment is not None:
            twist = n["moment"] / whole.stiffness
            yield main_result("twist", "twist of all parts under the moment, reduced", "rad"), twist
        for path, share in whole.within.items():
            words = f"stiffness of {path} about its own axis"
            yield main_result(f"{path}.stiffness", words, "N m rad-1"), share.stiffness
            words = f"share of {path} in the energy (in series: in the compliance)"
            yield main_result(f"{path}.share", words, "1"), share.energy
            if self.moment is not None:
                words = f"{path} about its own axis"
                yield main_result(f"{path}.moment", f"torque in {words}", "N m"), n["moment"] * share.moment
                yield main_result(f"{path}.twist", f"twist of {words}", "rad"), twist * share.twist

    def panels(self) -> tuple[Panel, ...]:
        """Each part's share of the energy (in series: of the twist), the softest part last."""
        own = self.own_values()
        shares = {name.removesuffix(".share"): value for name, value in own.items() if name.endswith(".share")}
        parts = sorted(shares, key=shares.get)
        stiffness = {part: quantity_text(own[f"{part}.stiffness"], "N m rad-1") for part in parts}
        names = [f"{part.replace('.', ' · ')}\n{text}" for part, text in stiffness.items()]
        title = f"whole line: {quantity_text(own['stiffness'], 'N m rad-1')}"
        if "twist" in own:
            title += f", {math.degrees(own['twist']):.3g}° under {quantity_text(self.moment, 'N m')}"
        x, y = PanelAxis("", "1"), PanelAxis("share of the energy", "%")
        bars = Curve("", np.array([shares[part] for part in parts]))
        return (Panel(x, y, np.arange(float(len(parts))), (bars,), title=title, kind="bars", names=names),)
