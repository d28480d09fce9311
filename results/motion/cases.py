"""Machines of the motion benchmark: scenes, random variants, right-hand sides that are independent of the engine.

A case starts at φ = 0 with a given speed and ends after a number of revolutions, where ω and t are compared.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import mechanics
import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from measuring import sample

from engine import Machine, Scene
from engine.scene.scene import scene_numbers
from sweeps.text.scene_text import read_scene

HERE = Path(__file__).parent
AGREEMENT = 1e-12


class Case(NamedTuple):
    """A machine, what varies, and its motion.

    Attributes
    ----------
    name, title : str
    scene : Scene
    varied : dict of str to float
        Paths of the numbers that vary, with their relative spread (half width of a uniform distribution).
    revolutions : int
    speed : float
        Speed of the crank at φ = 0 [rad/s].
    reduced : callable
        Given a square root, the function (cos φ, sin φ, ram, p) -> (I, dI/dφ, M) of the mechanism.
    motor : callable
        Reduced moment of the motor by (ω, p).
    pack, segments : callable
        Constants p from (numbers by path, scene), and jumps from (numbers by path, scene, π).
    """

    name: str
    title: str
    scene: Scene
    varied: dict[str, float]
    revolutions: int
    speed: float
    reduced: Callable
    motor: Callable
    pack: Callable
    segments: Callable


class Batch(NamedTuple):
    """Variants of a case, ready for any method; arrays have one column per variant.

    Attributes
    ----------
    varied : dict of str to ndarray (variants,)
        Input of the engine.
    p : ndarray (constants, variants)
        Constants of the right-hand side.
    edges : ndarray (segments + 1, variants)
        Angles [rad] of the start, all jumps and the end, from the x axis of the right-hand side: that of the guide of
        a slider-crank, else of the frame.
    ram : ndarray (segments, variants)
        Force on the ram between them [N].
    """

    varied: dict[str, np.ndarray]
    p: np.ndarray
    edges: np.ndarray
    ram: np.ndarray

    @property
    def variants(self) -> int:
        """Number of variants."""
        return self.p.shape[1]


def prepare(case: Case, varied: dict[str, np.ndarray], real: type = np.float64) -> Batch:
    """Constants and jumps of variants in float64 or long double."""
    variants = next(iter(varied.values())).size
    pi = 4 * np.arctan(real(1))
    numbers = {path: number.value for path, number in scene_numbers(case.scene).items()} | varied
    numbers = {path: np.asarray(values, real) for path, values in numbers.items()}
    found = case.pack(numbers, case.scene), *case.segments(numbers, case.scene, pi)
    p, edges, ram = (np.stack([np.broadcast_to(row, variants) for row in rows]) for rows in found)
    if not (np.diff(edges, axis=0) > 0).all():
        raise ValueError(f"{case.name}: a variant's jumps are not in the order the case assumes")
    turns = 2 * pi * np.arange(case.revolutions, dtype=real)[:, None, None]
    cuts = (edges[None, :-1] + turns).reshape(-1, variants)
    ram = np.tile(ram, (case.revolutions, 1))
    # Don't restart where a revolution continues the last one without a jump.
    jumps = [0, *(1 + np.flatnonzero((ram[1:] != ram[:-1]).any(axis=1)))]
    end = edges[:1] + 2 * pi * case.revolutions
    return Batch(varied, p, np.concatenate((cuts[jumps], end)), ram[jumps])


def require_engine_agrees(case: Case, variants: int = 5, positions: int = 24) -> None:
    """Stop if the engine's reduced inertia and moments differ from those of the right-hand sides."""
    varied = sample(case, variants, seed=2)
    fields = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment"]
    outcome = Machine(case.scene, fields=fields, varied=varied, positions=positions).evaluate(varied)
    batch = prepare(case, varied)
    phi = batch.edges[0, 0] + np.arange(positions) * (2 * np.pi / positions)
    part = np.array([np.searchsorted(batch.edges[:, i], phi, side="right") - 1 for i in range(variants)])
    ram = np.take_along_axis(batch.ram.T, part, axis=1)
    ours = case.reduced(np.sqrt)(np.cos(phi), np.sin(phi), ram, batch.p[:, :, None])
    for name, row in zip(fields, ours, strict=True):
        found = outcome.fields[name]
        worst = float(np.max(np.abs(found - row) / np.abs(row).max(axis=1, keepdims=True)))
        if not worst < AGREEMENT:
            raise SystemExit(f"{case.name}: {name} differs from the engine's by {worst:.1e} of its scale")


def _scene(name: str) -> Scene:
    return read_scene(HERE / f"{name}.toml")


CASES = {
    case.name: case
    for case in (
        Case(
            "slider_crank",
            "slider-crank, DC motor",
            _scene("slider_crank"),
            {
                "input.length": 0.2,
                "groups.drive.first.length": 0.2,
                "guides.way.y": 0.5,
                "bodies.ram_body.mass": 0.4,
                "bodies.crank_body.inertia": 0.4,
                "forces.feed.force": 0.4,
                "moments.motor.stall_moment": 0.25,
            },
            revolutions=17,
            speed=15.0,
            reduced=mechanics.slider_crank,
            motor=mechanics.dc_motor,
            pack=mechanics.pack_feeder,
            segments=mechanics.feeder_segments,
        ),
        Case(
            "crank_press",
            "crank press, induction motor",
            _scene("crank_press"),
            {
                "input.length": 0.1,
                "groups.drive.first.length": 0.2,
                "bodies.ram_body.mass": 0.3,
                "shafts.intermediate.inertia": 0.3,
                "forces.punching.scale": 0.3,
                "moments.friction.moment": 0.3,
                "moments.motor.breakdown_moment": 0.25,
                "moments.motor.breakdown_slip": 0.25,
            },
            revolutions=5,
            speed=4.1,
            reduced=mechanics.slider_crank,
            motor=mechanics.induction_motor,
            pack=mechanics.pack_press,
            segments=mechanics.press_segments,
        ),
        Case(
            "shaper",
            "shaper, induction motor",
            _scene("shaper"),
            {
                "input.length": 0.1,
                "points.O.y": 0.05,
                "bodies.ram_body.mass": 0.3,
                "bodies.lever_body.mass": 0.3,
                "shafts.flywheel.inertia": 0.3,
                "forces.cutting.scale": 0.3,
                "forces.ways.force": 0.3,
                "moments.motor.breakdown_moment": 0.25,
                "moments.motor.breakdown_slip": 0.25,
            },
            revolutions=5,
            speed=1.6,
            reduced=mechanics.shaper,
            motor=mechanics.induction_motor,
            pack=mechanics.pack_shaper,
            segments=mechanics.shaper_segments,
        ),
    )
}
