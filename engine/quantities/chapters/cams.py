"""Cams in a mechanism: follower displacement, pressure angle, profile, contact forces."""

from functools import partial

from engine.laws.elementary import angle_of
from engine.mechanism.mechanics import Mechanics
from engine.quantities.register import Declared, Field, known
from engine.scene.scene import Scene
from engine.words.quantity import Quantity


def cam_force_fields(scene: Scene) -> list[Quantity]:
    """Forces between the cams of a scene and their followers."""
    found = []
    for name, cam in scene.cams.items():
        pressed = "force along its guide" if cam.translating else "moment about its pivot"
        where = f"between cam {name} and {cam.follower.link}"
        touching = ", positive in compression" if cam.closure == "spring" else ""
        found.append(Quantity(f"{name}.contact_force", f"force {where}, along the normal{touching}", "N", symbol="N"))
        words = f"{pressed} that presses {cam.follower.link} on cam {name}, inertia included"
        found.append(Quantity(f"{name}.closing_force", words, "N" if cam.translating else "N m", symbol="P"))
    return found


def declare(mechanics: Mechanics) -> Declared:
    """Fields of every cam of the mechanism."""
    m, scene = mechanics, mechanics.scene
    for name, cam in scene.cams.items():
        motion, flat = m.kinematics.cams[name], cam.follower.contact == "flat"
        unit = "m" if cam.translating else "rad"
        words = f"displacement of {cam.follower.link} by cam {name}"
        yield Field(f"{name}.displacement", words, unit, known(motion.displacement), "s")
        if not flat:
            words = f"pressure angle of cam {name}, positive as on a rise"
            angle = partial(m.graph.apply, angle_of, motion.along, motion.across)
            yield Field(f"{name}.pressure_angle", words, "rad", angle, "α", ("peak",))
        words = f"transmission index of cam {name}: for a roller or knife edge, the cosine of the pressure angle"
        yield Field(f"{name}.transmission", words, "1", known(m.kinematics.sines[name]))
        for axis, node in zip("xy", m.kinematics.coordinates(motion.contact), strict=True):
            words = f"{axis} coordinate of the contact of cam {name} with {cam.follower.link}"
            yield Field(f"{name}.contact_{axis}", words, "m", known(node))
        for axis, node in zip("xy", motion.normal, strict=True):
            words = f"{axis} component of the unit normal at the contact, from cam {name} to {cam.follower.link}"
            yield Field(f"{name}.normal_{axis}", words, "1", known(node))
        words = f"curvature of the profile of cam {name} at the contact, positive if convex"
        yield Field(f"{name}.curvature", words, "m-1", known(motion.curvature), "κ")
        if motion.undercut:
            of = "the base radius" if flat else "that of the pitch curve"
            words = f"radius of curvature of the profile of cam {name} over {of}, zero at undercut"
            yield Field(f"{name}.undercut_margin", words, "1", known(motion.undercut[0]))
        if motion.face is not None:
            words = f"distance of the contact with cam {name} from the origin of {cam.follower.link}, along its face"
            yield Field(f"{name}.face_contact", words, "m", known(motion.face))
    for field in cam_force_fields(scene):
        answers = ("max", "min") if field.name.endswith(".contact_force") else ()
        yield Field.of(field, lambda name=field.name: m.reactions.variables[name], answers)
