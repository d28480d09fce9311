"""Elastic parts of a drive, single, in series and in parallel, as in a scene."""

from collections.abc import Callable
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.compliances.stiffnesses import at_radius, rods_at_radius, shaft_stiffness, teeth_at_radius
from engine.parts.actions import Stiffness, TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Area, Faults, Length, Name, Number, Part, Positive, quantity

PartModulus = Annotated[quantity("pressure"), Field(gt=0)]


class _TurningPart(Part):
    """Common keys of all parts: `ratio` is the speed of the part's axis over that of the shaft reduced to.

    `damping`, about the part's own axis, or `energy_absorption`, the fraction of its maximum energy dissipated in a
    cycle, defines its damper.
    """

    at_most_one_of: ClassVar = (("damping", "energy_absorption"),)
    # The torsional stiffness about the part's own axis, and the keys of its arguments.
    law: ClassVar[Callable[..., np.ndarray]] = staticmethod(np.asarray)
    law_keys: ClassVar[tuple[str, ...]] = ("stiffness",)

    ratio: Annotated[Number, Field(gt=0)] = 1.0
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    energy_absorption: Annotated[Number, Field(ge=0)] | None = None


class HollowRound(Part):
    """A round bar with a `diameter` and a `bore`."""

    ascending: ClassVar = {("bore", "diameter"): "no wall is left"}

    diameter: Positive
    bore: Annotated[Length, Field(ge=0)] = 0.0


class ShaftPart(HollowRound, _TurningPart):
    """A round shaft between two steps of its diameter."""

    law: ClassVar = staticmethod(shaft_stiffness)
    law_keys: ClassVar = ("diameter", "bore", "length", "shear_modulus")

    type: Literal["shaft"]
    length: Positive
    shear_modulus: PartModulus


class RodPart(_TurningPart):
    """A rod in tension, or a strand of a belt, whose force acts at a `radius`; the number of parallel `strands`."""

    law: ClassVar = staticmethod(rods_at_radius)
    law_keys: ClassVar = ("area", "length", "elastic_modulus", "radius", "strands")

    type: Literal["rod"]
    area: Annotated[Area, Field(gt=0)]
    length: Positive
    elastic_modulus: PartModulus
    radius: Positive
    strands: Annotated[Number, Field(ge=1)] = 1.0


class StrandPart(_TurningPart):
    """A belt, chain, rack or thread of known stiffness that acts at a `radius`."""

    law: ClassVar = staticmethod(at_radius)
    law_keys: ClassVar = ("stiffness", "radius")

    type: Literal["strand"]
    stiffness: Annotated[Stiffness, Field(gt=0)]
    radius: Positive


class MeshPart(_TurningPart):
    """A gear mesh, seen from the axis of the wheel with this `base_radius`; `mesh_stiffness` is per unit of face width.

    ISO 6336 gives 20 N/(mm µm) for usual spur gears of steel; 14 is more realistic under heavy load.
    """

    law: ClassVar = staticmethod(teeth_at_radius)
    law_keys: ClassVar = ("mesh_stiffness", "width", "base_radius")

    type: Literal["gear_mesh"]
    mesh_stiffness: PartModulus
    width: Positive
    base_radius: Positive


class CouplingPart(_TurningPart):
    """A coupling, key, spline or any other part of known torsional stiffness."""

    type: Literal["coupling"]
    stiffness: Annotated[TorsionalStiffness, Field(gt=0)]


class _PartsTogether(_TurningPart):
    """Several parts, each with its own damper."""

    type: Literal["series", "parallel"]
    parts: Annotated[dict[Name, "ElasticPart"], Field(min_length=1)]

    def _faults(self) -> Faults:
        for key in ("damping", "energy_absorption"):
            if getattr(self, key) is not None:
                yield f"{key}: parts in {self.type} have their own dampers; give it to them"


class SeriesPart(_PartsTogether):
    """Parts in series: each carries the whole moment."""

    type: Literal["series"]


class ParallelPart(_PartsTogether):
    """Parts in parallel: each is twisted by the whole angle."""

    type: Literal["parallel"]


ElasticPart = Annotated[
    ShaftPart | RodPart | StrandPart | MeshPart | CouplingPart | SeriesPart | ParallelPart, Field(discriminator="type")
]
SeriesPart.model_rebuild()
ParallelPart.model_rebuild()
