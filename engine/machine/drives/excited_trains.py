"""Excitation of torsional trains by the scene's machine: harmonics of its drive torque."""

from collections.abc import Callable

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.torsional_trains.excitation import MACHINE_HARMONICS
from engine.mechanism.mechanics import Mechanics
from engine.quantities.chapters.dynamics import input_moment_harmonic
from engine.quantities.expressions import Expression
from engine.quantities.register import mean
from engine.scene.scene import Numbers


def machine_harmonics(m: Mechanics) -> list[Expression]:
    """Mean inertia; mean of the drive torque at constant speed, then cosine and sine parts of its harmonics in turn."""
    harmonics = (part for k in range(1, MACHINE_HARMONICS + 1) for part in input_moment_harmonic(m, k))
    return [mean(m, m.reduced.inertia), mean(m, m.input_moment), *harmonics]


def machine_numbers(
    numbers: Numbers,
    m: Mechanics,
    expressions: list[Expression],
    value_of: Callable[[Expression], Measured],
    variants: int,
) -> dict[str, np.ndarray]:
    """Numbers of the machine for the trains that it excites.

    Parameters
    ----------
    numbers : Numbers
        Numbers of the scene.
    m : Mechanics
    expressions : list of Expression
        From `machine_harmonics`.
    value_of : callable
        Returns the measured value of an expression.
    variants : int

    Returns
    -------
    dict of str to ndarray (variants,)
        By their keys, such as "machine.inertia".
    """
    with np.errstate(all="ignore"):
        inertia, *found = (value_of(expression) for expression in expressions)
    values, errors = (
        [np.broadcast_to(part, (variants,)).astype(float) for part in parts]
        for parts in ([f.value for f in found], [f.error for f in found])
    )
    # The drive torque balances the torque on the train: M − ½ ω² dI/dφ is its negative.
    cosines, sines = [-values[0], *(-v for v in values[1::2])], [0.0 * values[0], *(-v for v in values[2::2])]
    off = [errors[0], *(a + b for a, b in zip(errors[1::2], errors[2::2], strict=True))]
    own = {"speed": numbers["input.speed"], "revolutions": m.scene.input.revolutions}
    wheel = numbers.get("flywheel.inertia", 0.0)
    own |= {"inertia": inertia.value + wheel, "inertia_error": inertia.error}
    for k, parts in enumerate(zip(cosines, sines, off, strict=True)):
        own |= {f"{name}_{k}": part for name, part in zip(("cosine", "sine", "error"), parts, strict=True)}
    return {f"machine.{key}": np.broadcast_to(np.asarray(value, float), (variants,)) for key, value in own.items()}
