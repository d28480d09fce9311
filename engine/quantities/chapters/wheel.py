"""The flywheel as a wheel: size, mass and stress."""

from collections.abc import Callable
from functools import cache
from operator import itemgetter

import numpy as np

from engine import elements
from engine.cycle.measured import Measured
from engine.mechanism.mechanics import Mechanics
from engine.quantities.chapters.dynamics import steady_cycle
from engine.quantities.expressions import Expression, Formula, VariantNumber
from engine.quantities.register import Declared, ranked_summary
from engine.scene.scene import scene_numbers

_SIZES = {
    "diameter": ("outer diameter of the flywheel", "m"),
    "mass": ("mass of the flywheel", "kg"),
    "width": ("width of the flywheel's rim", "m"),
    "thickness": ("radial thickness of the flywheel's rim", "m"),
    "rim_speed": ("peak rim speed of the flywheel", "m s-1"),
    "rim_speed_share": ("peak rim speed of the flywheel over its limit", "1"),
    "hoop_stress": ("hoop stress in the flywheel's rim", "Pa"),
    "energy": ("kinetic energy of the flywheel at its peak speed", "J"),
}
_ANSWERS = ("diameter", "mass", "width", "rim_speed", "hoop_stress", "burst_margin")
_BURSTING = {
    "burst_speed": ("speed of the input at which the flywheel bursts", "rad s-1"),
    "burst_margin": ("burst speed of the flywheel over its peak speed", "1"),
    "burst_energy": ("kinetic energy of the flywheel when it bursts", "J"),
    "burst_impulse": ("angular impulse at the input from the flywheel's peak speed to its bursting", "N m s"),
}


def declare(mechanics: Mechanics) -> Declared:
    """Sizes of the wheel, if the scene gives its design."""
    flywheel = mechanics.scene.flywheel
    if flywheel is None or flywheel.wheel is None or not flywheel.has_size:
        return

    @cache
    def sizes() -> Expression:
        """All sizes of the wheel with the required inertia at the peak speed, along a first axis."""
        paths = [path for path in scene_numbers(mechanics.scene) if path.startswith("flywheel.wheel.")]
        given = [VariantNumber(mechanics.graph.number(path)) for path in paths]
        operands = (steady_cycle(mechanics, "flywheel_used"), steady_cycle(mechanics, "speed_max"), *given)
        return Formula(_sizes_of(flywheel.wheel, paths), operands)

    for key, (words, unit) in (_SIZES if flywheel.wheel.strength is None else _SIZES | _BURSTING).items():
        summary = ranked_summary(key in _ANSWERS)
        yield summary(f"wheel_{key}", words, unit, lambda key=key: Formula(_size(key), (sizes(),)))


def _size(key: str) -> Callable[[Measured], Measured]:
    return itemgetter(elements.flywheel_wheels.Wheel._fields.index(key))


def _sizes_of(form: object, paths: list[str]) -> Callable[..., Measured]:
    def sizes(inertia: Measured, speed: Measured, *numbers: Measured) -> Measured:
        known = {path: number.value for path, number in zip(paths, numbers, strict=True)}

        def made(of: np.ndarray, at: np.ndarray) -> np.ndarray:
            return np.array(elements.flywheel_wheels.make_wheel(form, of, at, known))

        value = made(inertia.value, speed.value)
        heavier = made(inertia.value + inertia.error, speed.value)
        faster = made(inertia.value, speed.value + speed.error)
        return Measured(value, np.abs(heavier - value) + np.abs(faster - value) + 1e-15 * np.abs(value))

    return sizes
