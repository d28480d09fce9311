"""Friction in the pairs of a scene, `[friction.NAME]`."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.laws.friction.coefficients import MATERIALS
from engine.parts.skeleton import Angle, Faults, Number, Part, Positive, Refers, Speed
from engine.words.glossary import did_you_mean


class PairFriction(Part):
    """Friction in a pair: dry, or with a `coefficient` for the lubricated pair.

    `pair` is GROUP.first, GROUP.inner or GROUP.second, LINK.JOINT or LINK.GUIDE of a free link, input, a shaft with a
    pivot, CAM.guide or CAM.pivot of a cam's follower, or CAM.contact. At a cam contact a flat face or a knife edge
    slides on the cam; a roller has friction on its pin, of the given `diameter`. In a revolute pair `diameter` is that
    of the journal, and `contact` that with its bush: on a line, or on half the bush, new or worn in. Alternatively,
    `above_prismatic` raises the coefficient by the rule of practice, from 25 % (worn in) to 50 % (new). In a prismatic
    pair `form` is that of the guide. `length` is that of the slider, whose middle is its first joint (without a joint,
    its origin): under a large moment the slider tilts and bears on its edges; without a length only the normal force
    counts.

    `static_coefficient` with `stribeck_speed` raises the coefficient at low sliding speeds.
    """

    one_of: ClassVar = (("coefficient", "material"),)
    at_most_one_of: ClassVar = (("contact", "above_prismatic"),)
    together: ClassVar = (("static_coefficient", "stribeck_speed"),)
    required_with: ClassVar = {"vee_angle": ("form", ("vee",))}

    pair: Annotated[str, Refers("pair")]
    coefficient: Annotated[Number, Field(ge=0)] | None = None
    material: str | None = None
    diameter: Positive | None = None
    contact: Literal["line", "new", "worn in"] | None = None
    above_prismatic: Annotated[Number, Field(ge=0.25, le=0.5)] | None = None
    form: Literal["flat", "vee", "half-round, new", "half-round, worn in"] | None = None
    vee_angle: Annotated[Angle, Field(gt=0, le=3.141592653589793)] | None = None
    length: Positive | None = None
    static_coefficient: Annotated[Number, Field(ge=0)] | None = None
    stribeck_speed: Annotated[Speed, Field(gt=0)] | None = None

    def _faults(self) -> Faults:
        if self.material is not None and self.material not in MATERIALS:
            yield f"material {self.material!r} is not known; {did_you_mean(self.material, MATERIALS)}"
