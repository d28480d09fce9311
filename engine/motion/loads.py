"""Loads on the pairs of a machine, and what it does to its frame, at its true motion.

They follow from ω² and ε at every crank angle by the same steps as at uniform speed. ε comes from the equation of
motion, so what the input link needs for its equilibrium is what motors and flywheel give.

A flywheel loads no pair but by its weight, which a scene doesn't know; its inertia turns the frame.
"""

from collections.abc import Iterable, Mapping

import numpy as np

from engine.machine.input_motion import InputMotion
from engine.machine.model import Model
from engine.machine.quantities.shaking import shaking_terms
from engine.motion.moments.dynamics import Variants
from engine.motion.moments.tabulation import Tabulation

# Names of a scene hold no two underscores in a row.
TRUE = InputMotion("true__square", "true__epsilon", "true__speed")
# Moments in which the inertia of a flywheel takes part.
WITH_FLYWHEEL = ("frame.reaction_moment", "shaking_moment")


class PairLoads:
    """Reactions in the pairs and shaking forces of a model, however its input moves.

    Parameters
    ----------
    model : Model
    asked : iterable of str
        Fields, by the names that they have at uniform speed.

    Attributes
    ----------
    names : tuple of str
        The fields.
    groups : tuple of str
        Structural groups that they depend on.
    """

    def __init__(self, model: Model, asked: Iterable[str]) -> None:
        self.model, self.names = Model(model.scene, model.varied, TRUE), tuple(sorted(set(asked)))
        known = self.model.reactions.variables | self._shaking()
        self.tabulation = Tabulation(self.model, {name: known[name] for name in self.names}, tuple(TRUE))
        made = {target for step in self.tabulation.steps for target in step.targets}
        self.groups = tuple(g for g, sine in self.model.mechanism.sines.items() if sine in made)

    def _shaking(self) -> dict[str, str]:
        """Variables of the shaking force and moment: those of ω² r″, and with ε those of r′."""
        scene, p, m = self.model.scene, self.model.program, self.model.mechanism
        square, epsilon = (shaking_terms(scene, m, p, by) for by in ("square", "epsilon"))
        found = {}
        for name in square:
            p.about("shaking force", "force")
            parts = [(TRUE.square, square[name]), (TRUE.epsilon, epsilon[name])]
            sums = [f"{rate} * ({' + '.join(f'{c} * {b}' for c, b in terms)})" for rate, terms in parts if terms]
            found[name] = p.fresh(" + ".join(sums)) if sums else "zero"
        x, y = found["shaking_force_x"], found["shaking_force_y"]
        return found | {"shaking_force": p.fresh(f"math.sqrt({x} * {x} + {y} * {y})")}

    def __call__(
        self,
        variants: Variants,
        places: np.ndarray,
        omega: np.ndarray,
        epsilon: np.ndarray,
        wheel: np.ndarray,
        off: frozenset[str],
    ) -> Mapping[str, np.ndarray]:
        """The fields at given places of a motion, each (places, variants).

        Parameters
        ----------
        variants : Variants
        places : ndarray (places, variants)
            Crank angles [rad].
        omega : ndarray (places, variants)
            Speed by magnitude [rad/s].
        epsilon : ndarray (places, variants)
            Acceleration, counter-clockwise positive [rad/s²].
        wheel : ndarray (variants,)
            Inertia of the flywheel, reduced to the input [kg·m²].
        off : frozenset of str
            Actions that don't act.
        """
        parameters = self.tabulation.parameters(variants.numbers, variants.count, variants.direction)
        silent = self._coefficients(off)
        parameters[[slot in silent for slot in self.tabulation.slots]] = 0.0
        given = np.stack((omega * omega, epsilon, omega))
        rows = self.tabulation(parameters, variants.ends, places, given=given)
        found = dict(zip(self.names, rows, strict=True))
        made = self.model.scene.flywheel
        # The wheel's shaft turns so many times as fast, with an inertia smaller by the square of it.
        ratio = variants.numbers["flywheel.wheel.ratio"] if made is not None and made.wheel is not None else 1.0
        for name in WITH_FLYWHEEL:
            if name in found:
                found[name] = found[name] - wheel / ratio * epsilon
        return found

    def _coefficients(self, actions: frozenset[str]) -> set[str]:
        """Slots that are zero where some of the actions don't act."""
        moments = self.model.moments
        found = {applied.coefficient for applied in moments.applied if applied.action in actions}
        if "gravity" in actions:
            found |= {moments.weight(name) for name in self.model.mechanism.masses}
        return found
