"""Pins and rods whose stresses are computed, `[pins.NAME]` and `[struts.NAME]`."""

from typing import Annotated, Literal

from pydantic import Field

from engine.parts.skeleton import Faults, LinkRef, Number, Part, Positive, Refers

# The materials of `engine.laws.buckling`.
StrutMaterialName = Literal["S235", "E335", "grey cast iron"]


class Pin(Part):
    """The pin of a revolute pair: its `diameter` and the `width` of its bearing.

    `pair` is GROUP.first, GROUP.inner or GROUP.second, LINK.JOINT of a free link, input, or a shaft with a pivot.
    """

    pair: Annotated[str, Refers("revolute pair")]
    diameter: Positive
    width: Positive


class Strut(Part):
    """A rod between two joints that may buckle: of a `diameter`, a tube, or flat with a `width` and a `thickness`.

    `end_fixity` is the effective length over the distance of its joints, 1 between two pins. `material` is S235 (mild
    structural steel), E335 (harder machine steel) or grey cast iron.
    """

    link: Annotated[LinkRef, Refers("rod")]
    material: StrutMaterialName = "S235"
    diameter: Positive | None = None
    inner_diameter: Positive | None = None
    width: Positive | None = None
    thickness: Positive | None = None
    end_fixity: Annotated[Number, Field(gt=0)] = 1.0

    def _faults(self) -> Faults:
        round_one, flat_one = self.diameter is not None, self.width is not None and self.thickness is not None
        if round_one == flat_one or (round_one and (self.width or self.thickness)):
            yield "give the diameter of a round rod, or width and thickness of a flat one"
        if self.inner_diameter is not None and not (round_one and self.inner_diameter < self.diameter):
            yield "inner_diameter belongs to a tube: give a larger diameter with it"
