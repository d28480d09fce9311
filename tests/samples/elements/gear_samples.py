"""Gear trains for tests: the classical arrangements, as scenes have them."""

import math

import numpy as np

STANDARD = math.radians(20)


def tips_keep_clear(z1, z2, sense=1):
    """Whether no tip reaches beyond where the line of action touches the other base circle; arrays, no shifts."""
    bases = z1 * np.cos(STANDARD), z2 * np.cos(STANDARD)
    line = (z2 + sense * z1) * np.sin(STANDARD)
    outer = z2 + 2 * sense
    first = np.sqrt((z1 + 2) ** 2 - bases[0] ** 2) <= line if sense > 0 else True
    reach = np.sqrt(np.maximum(outer**2 - bases[1] ** 2, 0))
    return first & ((reach <= line) if sense > 0 else (reach >= line))


def toothed(**wheels):
    """Wheels by their names: the shaft and the number of teeth of each."""
    return {name: {"shaft": shaft, "teeth": teeth} for name, (shaft, teeth) in wheels.items()}


def simple_planetary(sun, planet, ring, roles, planets=None, mesh=None, **train):
    """Sun, planets on an arm, ring: `roles` gives keys of the shafts sun_shaft, arm, ring_shaft."""
    arm = {} if planets is None else {"planets": planets}
    return {
        "type": "gear_train",
        "wheels": toothed(sun=("sun_shaft", sun), planet=("idler", planet), ring=("ring_shaft", ring)),
        "shafts": {
            "sun_shaft": roles.get("sun", {}),
            "idler": {"carrier": "arm"} | roles.get("idler", {}),
            "arm": arm | roles.get("arm", {}),
            "ring_shaft": roles.get("ring", {}),
        },
        "meshes": {
            "outer": {"between": ["sun", "planet"]} | (mesh or {}),
            "inner": {"between": ["planet", "ring"], "type": "internal"} | (mesh or {}),
        },
    } | train


def stepped_planetary(z1, z2, z3, z4, roles, internal=False, planets=None, mesh=None, **train):
    """Two central wheels 1 and 4 joined by a planet with wheels 2 and 3, 4 outside or a ring; modules to suit."""
    arm = {} if planets is None else {"planets": planets}
    kind = {"type": "internal"} if internal else {}
    distance = z1 + z2
    module = distance / (z4 - z3 if internal else z3 + z4)
    return {
        "type": "gear_train",
        "wheels": toothed(
            first=("first_shaft", z1), second=("block", z2), third=("block", z3), fourth=("fourth_shaft", z4)
        ),
        "shafts": {
            "first_shaft": roles.get("first", {}),
            "block": {"carrier": "arm"} | roles.get("block", {}),
            "arm": arm | roles.get("arm", {}),
            "fourth_shaft": roles.get("fourth", {}),
        },
        "meshes": {
            "one": {"between": ["first", "second"], "module": 0.001} | (mesh or {}),
            "two": {"between": ["third", "fourth"], "module": 0.001 * module} | kind | (mesh or {}),
        },
    } | train
