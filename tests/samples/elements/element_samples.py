"""Machine elements of all simple kinds, and how they are asked by themselves."""

import numpy as np

from engine import ElementsAlone, Scene, Verdict

# Budynas & Nisbett, Shigley's, example 8-1: 26.18 and 9.77 N·m, efficiency 0.311.
JACK = {
    "type": "screw",
    "load": 6400.0,
    "mean_diameter": 0.030,
    "pitch": 0.004,
    "starts": 2,
    "thread": "square",
    "friction": 0.08,
    "collar_diameter": 0.040,
    "collar_friction": 0.08,
}
BELT = {"type": "belt", "diameter": 0.2, "wrap": 3.0, "friction": 0.3, "tension": 900.0}
WEDGE = {"type": "wedge", "load": 5e3, "angle": 0.14, "friction": 0.15}
INCLINE = {"type": "incline", "load": 1e3, "angle": 0.35, "friction": 0.3}
JOURNAL = {"type": "journal", "load": 2e3, "diameter": 0.05, "friction": 0.1}
GUIDE = {"type": "guide", "length": 0.2, "friction": 0.1, "load": 100.0, "resistance": 500.0, "overhang": 0.15}
ROLLER = {"type": "roller", "load": 1e4, "diameter": 0.6, "rolling_arm": 5e-4, "friction": 0.2}
TILTED = {"type": "tilted_body", "mass": 8.0, "semi_axis_x": 0.1, "semi_axis_y": 0.2, "semi_axis_z": 0.3, "pitch": 0.1}
LEVER = {"type": "rotating_guide", "mass": 0.4, "speed": 20.0, "start_radius": 0.1, "length": 0.5}
WOUND = {
    "type": "wound_flywheel",
    "bore": 0.1,
    "winding_diameter": 0.2,
    "diameter": 0.6,
    "width": 0.05,
    "density": 7850.0,
    "winding_stress": 3e8,
    "speed": 600.0,
}
DISC = {
    "type": "static_rotor",
    "correction_radius": 0.2,
    "mass": 30.0,
    "rolling_arm": 5e-5,
    "speed": 50.0,
    "unbalances": {
        "a": {"mass": 0.2, "radius": 0.2, "angle": 0.0},
        "b": {"mass": 0.3, "radius": 0.15, "angle": 0.8},
        "c": {"mass": 0.24, "radius": 0.25, "angle": 2.4},
    },
}
TIE = {"type": "tethered_body", "mass": 2.0, "length": 1.2, "stiffness": 4e4, "strength": 3e3, "speed": 25.0}
FRICTION = {
    "type": "friction_drive",
    "driving_diameter": 0.1,
    "driven_diameter": 0.25,
    "friction": 0.2,
    "creep": 0.01,
    "speed": 50.0,
    "moment": 20.0,
}
CHAIN = {"type": "chain_drive", "pitch": 0.0127, "driving_teeth": 17, "driven_teeth": 51, "speed": 50.0, "moment": 60.0}
CAR = {
    "type": "car",
    "speed": 50 / 3.6,
    "friction": 0.6,
    "wheelbase": 2.8,
    "rear_distance": 1.2,
    "height": 0.6,
    "gravity": 9.81,
    "slope": 0.0,
}
TWO_MASSES = {
    "type": "two_mass_drive",
    "motor_inertia": 0.5,
    "load_inertia": 3.0,
    "stiffness": 2e4,
    "backlash": 0.02,
    "load_moment": 60.0,
    "time": 0.05,
}
EVERY = {"jack": JACK, "drive": BELT, "key": WEDGE, "ramp": INCLINE, "pin": JOURNAL, "way": GUIDE, "wheel": ROLLER}
EVERY |= {"egg": TILTED, "lever": LEVER, "tape": WOUND, "disc": DISC, "tie": TIE, "wheels": FRICTION, "chain": CHAIN}


def scene(**elements):
    return Scene.model_validate({"elements": elements})


def results(data, *names, **varied):
    """Values, error estimates and status of one element, of all it has unless named; paths with dots or __ for them."""
    paths = {f"elements.it.{key.replace('__', '.')}": np.atleast_1d(value) for key, value in varied.items()}
    machine = scene(it=data)
    asked = [f"it.{name}" for name in names] or ElementsAlone(machine).available_summaries
    outcome = ElementsAlone(machine, asked, varied=paths).evaluate(paths)
    values, errors = ({n[3:]: table[n] for n in asked} for table in (outcome.summaries, outcome.errors))
    return values, errors, outcome.status


def solved(data, *names, **varied):
    """Results and their error estimates, (value, error), of an element that has them; arrays where numbers vary."""
    values, errors, status = results(data, *names, **varied)
    assert (status == Verdict.OK).all(), status
    shape = np.asarray if varied else (lambda column: float(column[0]))
    return {name: (shape(values[name]), shape(errors[name])) for name in values}


def figures(data, *names, **varied):
    """Results and their error estimates in the order asked."""
    return list(solved(data, *names, **varied).values())


def one(data, *names, **changes):
    """Results alone, of an element with some of its numbers changed."""
    return [value for value, _ in figures(data | changes, *names)]


def element(data):
    """The element that some data describe, alone."""
    return scene(it=data).elements["it"]
