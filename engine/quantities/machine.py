"""All quantities of a machine, chapter by chapter."""

from engine.mechanism.mechanics import Mechanics
from engine.quantities import cams, dynamics, friction, inertia, kinematics, loops, reactions, strokes, wanted, wheel
from engine.quantities.register import Register

CHAPTERS = (kinematics, cams, strokes, wanted, loops, dynamics, wheel, inertia, reactions, friction)


def register_of(mechanics: Mechanics) -> Register:
    """The register of a machine: to add a quantity, declare it in the file of its chapter."""
    return Register(mechanics, (quantity for chapter in CHAPTERS for quantity in chapter.declare(mechanics)))
