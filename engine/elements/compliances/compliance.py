"""Elastic parts of a drive in series: stiffness and damping reduced to one shaft, and the contribution of each part."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.elements.compliances.reduction import damping_and_absorption, in_series, leaf_paths, reduced_part
from engine.elements.element import Columns, Element, ElementResult, Numbers
from engine.elements.panels import Curve, Panel, PanelAxis
from engine.parts.actions import Moment
from engine.parts.skeleton import Name, quantity
from engine.units.display import quantity_text


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

    def results(self) -> tuple[ElementResult, ...]:
        """Results of the whole and of every part."""
        given = {key: getattr(self, key) is not None for key in ("moment", "frequency")}
        found = [
            ElementResult("stiffness", "torsional stiffness of all parts, reduced", "N m rad-1"),
            ElementResult("compliance", "torsional compliance of all parts, reduced", "rad N-1 m-1"),
            ElementResult("energy_absorption", "energy absorption of all parts", "1"),
        ]
        if given["frequency"]:
            found.append(ElementResult("damping", "torsional damping of all parts, reduced", "N m s rad-1"))
        if given["moment"]:
            found.append(ElementResult("twist", "twist of all parts under the moment, reduced", "rad"))
        for path in leaf_paths(self.parts):
            found.append(ElementResult(f"{path}.stiffness", f"stiffness of {path} about its own axis", "N m rad-1"))
            words = f"share of {path} in the energy, in series that in the compliance"
            found.append(ElementResult(f"{path}.share", words, "1"))
            if given["moment"]:
                found.append(ElementResult(f"{path}.moment", f"moment of {path} about its own axis", "N m"))
                found.append(ElementResult(f"{path}.twist", f"twist of {path} about its own axis", "rad"))
        return tuple(found)

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        whole = in_series({name: reduced_part(part, n, f"parts.{name}") for name, part in self.parts.items()})
        found = {
            "stiffness": whole.stiffness,
            "compliance": 1.0 / whole.stiffness,
            "energy_absorption": whole.absorption,
        }
        if self.frequency is not None:
            found["damping"], found["energy_absorption"] = damping_and_absorption(whole, n["frequency"])
        for path, share in whole.within.items():
            found |= {f"{path}.stiffness": share.stiffness, f"{path}.share": share.energy}
            if self.moment is not None:
                found[f"{path}.moment"] = n["moment"] * share.moment
                found[f"{path}.twist"] = n["moment"] / whole.stiffness * share.twist
        if self.moment is not None:
            found["twist"] = n["moment"] / whole.stiffness
        return found

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Each part's share of the energy (in series: of the twist), the softest part last."""
        own = self.own_values()
        shares = {name.removesuffix(".share"): value for name, value in own.items() if name.endswith(".share")}
        parts = sorted(shares, key=shares.get)
        names = [
            f"{part.replace('.', ' · ')}\n{quantity_text(own[f'{part}.stiffness'], 'N m rad-1')}" for part in parts
        ]
        title = f"whole line: {quantity_text(own['stiffness'], 'N m rad-1')}"
        if "twist" in own:
            title += f", {math.degrees(own['twist']):.3g}° under {quantity_text(self.moment, 'N m')}"
        x, y = PanelAxis("", "1"), PanelAxis("share of the energy", "%")
        bars = Curve("", np.array([shares[part] for part in parts]))
        return (Panel(x, y, np.arange(float(len(parts))), (bars,), title=title, kind="bars", names=names),)
