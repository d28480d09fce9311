"""Time per variant of elastic links on one thread: python results/elastic/timings.py.

The minimum processor time of several runs, which other work on the machine affects least.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from measuring import least_time

from engine import ElementsAlone, Scene, set_threads

VARIANTS = 20_000


def train(masses: int, **others: object) -> dict:
    """A free chain of equal masses and shafts; its losses only matter under an excitation."""
    shaft = {"stiffness": 1e4} | ({"energy_absorption": 0.05} if "excitations" in others else {})
    return {
        "type": "torsional_train",
        "masses": {f"m{i}": {"inertia": 1.0} for i in range(masses)},
        "shafts": {f"s{i}": {"between": [f"m{i}", f"m{i + 1}"]} | shaft for i in range(masses - 1)},
        "modes": masses - 1,
        **others,
    }


ORDERS = {f"e{h}": {"on": "m0", "order": h, "amplitude": 10.0} for h in range(1, 13)}
START = {
    "type": "two_mass_drive",
    "motor_inertia": 0.5,
    "load_inertia": 3.0,
    "stiffness": 2e4,
    "damping_ratio": 0.03,
    "backlash": 0.02,
    "motor_moment": 100.0,
    "load_moment": 60.0,
    "time": 0.05,
}
INDUCTION = {
    "type": "induction",
    "power": 15e3,
    "rated_speed": 152.4,
    "synchronous_speed": 157.1,
    "breakdown_ratio": 2.6,
    "starting_ratio": 1.4,
}
ROTOR = {
    "type": "oscillator",
    "mass": 40.0,
    "stiffness": 4e5,
    "damping_ratio": 0.04,
    "excitation": {"type": "unbalance", "mass": 0.02, "radius": 0.08, "speed": 150.0},
}
CASES = {
    "train of 6 masses: 5 frequencies and modes": (train(6), "shafts.s2.stiffness"),
    "train of 20 masses: 19 frequencies and modes": (train(20), "shafts.s2.stiffness"),
    "train of 6 masses under 12 orders": (train(6, speed=10.0, excitations=ORDERS), "shafts.s2.stiffness"),
    "start through backlash, with its estimates": (START, "stiffness"),
    "the same under an induction motor": (
        {key: value for key, value in START.items() if key != "motor_moment"} | {"motor": INDUCTION},
        "stiffness",
    ),
    "one mass, forced, with its estimates": (ROTOR, "stiffness"),
    "one mass, run through its resonance too": (
        ROTOR | {"run_through": {"start": 150.0, "acceleration": -2.0}},
        "stiffness",
    ),
}


def microseconds(element: dict, path: str, variants: int) -> float:
    """Processor time of one variant, one of its numbers varied."""
    scene = Scene.model_validate({"elements": {"it": element}})
    path = f"elements.it.{path}"
    names = list(ElementsAlone(scene).available_summaries)
    ready = ElementsAlone(scene, names, varied=[path])
    values = {path: np.random.default_rng(1).uniform(1e4, 1e5, variants)}
    return least_time(lambda: ready.evaluate(values)) / variants * 1e6


if __name__ == "__main__":
    set_threads(1)
    for name, (element, path) in CASES.items():
        count = VARIANTS // 10 if "run through" in name else VARIANTS
        print(f"{name:50s} {microseconds(element, path, count):8.2f} µs per variant")
