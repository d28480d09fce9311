"""Torsional trains, and their matrices made by gear constraints, q = T q_free, instead of by reduction."""

import numpy as np
from element_samples import element, solved


def chain(inertias, stiffnesses, **others):
    """A chain of masses m0, m1, … and shafts s0, s1, …, free at both ends."""
    masses = {f"m{i}": {"inertia": float(x)} for i, x in enumerate(inertias)}
    shafts = {f"s{i}": {"between": [f"m{i}", f"m{i + 1}"], "stiffness": float(k)} for i, k in enumerate(stiffnesses)}
    return {"type": "torsional_train", "masses": masses, "shafts": shafts, "modes": 50, **others}


# A motor drives through a reducer with two outputs; one of them is held to the frame by a torsion bar.
BRANCHED = {
    "type": "torsional_train",
    "masses": {
        "motor": {"inertia": 0.3, "damping": 0.05},
        "pinion": {"inertia": 0.02},
        "wheel": {"inertia": 0.9, "damping": 0.2},
        "second_wheel": {"inertia": 0.4},
        "table": {"inertia": 12.0, "damping": 1.0},
        "fan": {"inertia": 1.5, "damping": 0.1},
    },
    "shafts": {
        "motor_shaft": {"between": ["motor", "pinion"], "stiffness": 2e4, "damping": 1.0},
        "table_shaft": {"between": ["table", "wheel"], "stiffness": 8e4, "energy_absorption": 0.2},
        "fan_shaft": {"between": ["second_wheel", "fan"], "stiffness": 3e4, "damping": 3.0},
    },
    "gears": {
        "first_mesh": {"between": ["pinion", "wheel"], "ratio": -0.25},
        "second_mesh": {"between": ["second_wheel", "pinion"], "ratio": -2.0},
    },
    "modes": 10,
    "speed": 40.0,
}


def free(train):
    """A train that nothing excites: without its speed and its dampers."""
    kept = {key: value for key, value in train.items() if key != "speed"}
    for group in ("masses", "shafts"):
        kept[group] = {
            name: {key: value for key, value in part.items() if key not in ("damping", "energy_absorption")}
            for name, part in train[group].items()
        }
    return kept


def matrices(train, frequency=0.0):
    """M, K and complex D = K + i w B − w² M of the free angles, and T, so that angles of masses are T q_free.

    Masses as named by the train; all about their own axes.
    """
    masses = list(train["masses"])
    count = len(masses)
    at = {mass: i for i, mass in enumerate(masses)}
    inertia = np.diag([m["inertia"] for m in train["masses"].values()])
    damping = np.diag([m.get("damping", 0.0) for m in train["masses"].values()])
    stiffness, lossy = np.zeros((count, count)), np.zeros((count, count), complex)
    for shaft in train["shafts"].values():
        twist = np.zeros(count)
        first, second = shaft["between"]
        if first != "frame":
            twist[at[first]] += 1.0
        if second != "frame":
            twist[at[second]] -= 1.0 / shaft.get("ratio", 1.0)
        k, loss = shaft["stiffness"], shaft.get("energy_absorption", 0.0) / (2 * np.pi)
        stiffness += k * np.outer(twist, twist)
        lossy += k * (1 + 1j * loss) * np.outer(twist, twist)
        damping = damping + shaft.get("damping", 0.0) * np.outer(twist, twist)
    # Gears: θ_second = ratio · θ_first; the free angles are a basis of what they allow.
    constraints = []
    for gear in train.get("gears", {}).values():
        row = np.zeros(count)
        row[at[gear["between"][1]]], row[at[gear["between"][0]]] = 1.0, -gear["ratio"]
        constraints.append(row)
    basis = np.eye(count)
    if constraints:
        _, sizes, vectors = np.linalg.svd(np.array(constraints))
        basis = vectors[len(sizes) :].T
    dynamic = lossy + 1j * frequency * damping - frequency**2 * inertia
    return *(basis.T @ matrix @ basis for matrix in (inertia, stiffness, dynamic)), basis


def frequencies_of(train, **varied):
    """Natural frequencies above zero and their figures."""
    count = element(train).reported_modes
    found = solved(train, *(f"frequency_{k}" for k in range(1, count + 1)), **varied)
    return tuple(np.array(part) for part in zip(*found.values(), strict=True))
