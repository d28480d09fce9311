"""All quantities of a machine, chapter by chapter."""

from engine.mechanism.mechanics import Mechanics
from engine.quantities import chapters
from engine.quantities.register import Register

# The chapters in the order of their results, each with the tables of a scene that it covers: it is loaded if the scene
# has any of them. Chapters without tables apply to every machine.
CHAPTERS = {
    "strokes": (),
    "wanted": ("wanted",),
    "cylinders": ("cylinders",),
    "loops": (),
    "kinematics": (),
    "cams": ("cams",),
    "reactions": (),
    "strength": ("pins", "struts"),
    "friction": ("friction", "shafts", "noncircular_wheels", "racks", "pinions"),
    "dynamics": (),
    "wheel": ("flywheel",),
    "inertia": (),
}


def register_of(mechanics: Mechanics) -> Register:
    """The register of a machine. To add a quantity, declare it in the module of its chapter."""
    scene = mechanics.scene
    names = [name for name, parts in CHAPTERS.items() if not parts or any(getattr(scene, part) for part in parts)]
    return Register(mechanics, (one for name in names for one in getattr(chapters, name).declare(mechanics)))
