"""Friction in all pairs by Newton and Euler: the dense equations of motion and |R| of every pair, solved together.

Friction is one more force or couple in every rubbing pair, of the size of its pressing force, which SciPy's `fsolve`
finds at each position by itself, led from no friction to all of it in steps.
"""

import numpy as np
from newton_euler import Unknown, balances, coefficients, external, momentum, unknowns
from oracle import REAL, Motion
from scipy.optimize import fsolve

from engine import Scene
from engine.scene.pairs import pairs

STEPS = 8


def _rubs(motion: Motion) -> list[tuple[Unknown, np.ndarray, np.ndarray]]:
    """Of each rubbing pair: a newton's friction, the rate at which it does work, half of the slider's length."""
    scene, known = motion.scene, {pair.name: pair for pair in pairs(motion.scene)}
    links, forward, found = motion.links, np.sign(motion.scene.input.speed), []
    for friction in scene.friction.values():
        pair, f = known[friction.pair], friction.coefficient
        on = {pair.link: 1.0, pair.other: -1.0}
        if pair.kind == "revolute":
            rate = links[pair.link].theta.d - links[pair.other].theta.d + 0 * motion.q
            arm = friction.diameter / 2 * np.sin(np.arctan(f)) * {None: 1, "worn in": 4 / np.pi}[friction.contact]
            place, direction = None, (0, 0)
        else:
            slider = links[pair.link]
            rate, arm = motion.slides[pair.link].d + 0 * motion.q, f
            place, direction = (slider.x.v, slider.y.v), (slider.c.v, slider.s.v)
        size = -np.sign(rate) * forward * arm
        unit = Unknown(friction.pair, {name: sign * size for name, sign in on.items()}, place, direction)
        found.append((unit, np.abs(rate) * arm, (friction.length or np.inf) / 2))
    return found


def _pressing(names: list[str], solution: np.ndarray, name: str, half: float) -> float:
    if f"{name}.reaction" in names:
        normal, moment = (solution[names.index(f"{name}.reaction{end}")] for end in ("", "_moment"))
        return max(abs(normal), abs(moment) / half)
    return np.hypot(*(solution[names.index(f"{name}.reaction_{axis}")] for axis in "xy"))


def with_friction(scene: Scene, q: np.ndarray) -> dict[str, np.ndarray]:
    """Reactions, input moment and reduced moment of friction by the engine's names; NaN where nothing is found."""
    motion = Motion(scene, q)
    (inside, outside), rates = external(motion), momentum(motion, REAL(scene.input.speed) ** 2, 0.0)
    columns, rubs = unknowns(motion), _rubs(motion)
    names = [unknown.name for unknown in columns]
    matrix = coefficients(motion, columns).astype(float)
    rows = balances(motion)
    right = np.stack([(rates.of[n] - inside.of[n] - outside.of[n])[part] for n, part in rows], axis=-1).astype(float)
    friction = coefficients(motion, [unit for unit, _, _ in rubs]).astype(float)
    found = np.full((len(q), len(columns)), np.nan)
    lost = np.full(len(q), np.nan)
    for k in range(len(q)):
        free, backs = np.linalg.solve(matrix[k], right[k]), -np.linalg.solve(matrix[k], friction[k])

        def gap(n: np.ndarray, share: float, free: np.ndarray = free, backs: np.ndarray = backs) -> np.ndarray:
            solution = free + backs @ (share * n)
            return np.array([_pressing(names, solution, u.name, half) for u, _, half in rubs]) - n

        n, arrived = gap(np.zeros(len(rubs)), 0.0), 1
        for share in np.arange(1, STEPS + 1) / STEPS:
            n, _, arrived, _ = fsolve(gap, n, (share,), full_output=True, xtol=1e-13)
        if arrived == 1 or np.abs(gap(n, 1.0)).max() < 1e-11 * np.abs(n).max():
            found[k] = free + backs @ n
            lost[k] = sum(rate[k] * force for (_, rate, _), force in zip(rubs, n, strict=True))
    rows = dict(zip(names, found.T, strict=True))
    return rows | {
        "friction_moment": -np.sign(scene.input.speed) * lost,
        "input_moment_with_friction": rows["input_moment"],
    }
