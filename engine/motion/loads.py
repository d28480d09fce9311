"""Loads on the pairs of a machine, and shaking forces on its frame, for its actual motion.

They follow from ω² and ε at every crank angle by the same equations as at constant speed. ε is from the equation of
motion, so the torque that the input link needs for equilibrium is that of motors and flywheel.

A flywheel loads the pairs by its weight only, which a scene does not contain; its inertia affects the frame.
"""

from collections.abc import Iterable

import numpy as np

from engine.graph.functions import functions_at
from engine.graph.nodes import Given, Node
from engine.mechanism.actions.motors import motor_at_speed, motor_on_shaft
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.inertia import shaking
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.mechanics import Mechanics
from engine.mechanism.reactions import Reactions
from engine.motion.moments.dynamics import Variants
from engine.motion.moments.own_drives import WithServos, loads_of
from engine.motion.moments.tabulation import Tabulation

# Moments that include the inertia of the flywheel.
WITH_FLYWHEEL = ("frame.reaction_moment", "shaking_moment")


class PairLoads:
    """Reactions in the pairs and shaking forces of a machine for any motion of its input.

    Parameters
    ----------
    mechanics : Mechanics
    asked : iterable of str
        Fields, by their names at constant speed.

    Attributes
    ----------
    names : tuple of str
        The fields.
    nodes : list of Node
        The fields, in the graph of the mechanics.
    """

    def __init__(self, mechanics: Mechanics, asked: Iterable[str]) -> None:
        graph, kinematics = mechanics.graph, mechanics.kinematics
        self.scene, self.names = mechanics.scene, tuple(sorted(set(asked)))
        speed, square, epsilon = (graph.given(f"{part} of the input") for part in ("speed", "square", "acceleration"))
        motion = InputMotion(square, epsilon, speed)
        # The coefficient of each load is a number of the variant: 0 for actions that are off.
        self._sizes: dict[Given, tuple[str, Node]] = {}
        acting = loads_of(mechanics, graph.given("time"), speed, epsilon=epsilon)
        if isinstance(acting, WithServos):
            kinematics, motion = acting.true, InputMotion(graph.one, graph.zero, speed)
        self._facing, direction = graph.given("facing of the motors"), input_sense(kinematics)
        on_shafts = []
        for name in acting.motors:
            reduced = motor_at_speed(kinematics, name, graph.one, self._facing, speed)
            load = motor_on_shaft(acting.kinematics, name, reduced, direction)
            on_shafts.append(load._replace(coefficient=graph.derived(f"motor {name} is there", lambda n: 1.0)))
        loads = []
        for i, load in enumerate((*acting.terms, *on_shafts)):
            size = graph.given(f"size of load {i}")
            self._sizes[size] = load.action, load.coefficient
            loads.append(load._replace(coefficient=size))
        known = Reactions(kinematics, mechanics.structure, loads, motion).variables | _shaking(kinematics, motion)
        # Motors give a part of the torque that the input needs.
        given = sum((load.coefficient * load.basis for load in loads[len(acting.terms) :]), graph.zero)
        known["input_moment_by_equilibrium"] = known["input_moment_by_equilibrium"] + given
        self.nodes = [known[name] for name in self.names]
        coefficients = [coefficient for _, coefficient in self._sizes.values()]
        functions = functions_at(graph, mechanics.first, mechanics.last, self.nodes, numbers=coefficients)
        self._tabulation = Tabulation(functions)
        self._rows = {name: functions.curves[known[name]] for name in self.names}
        self._moving = {speed: 0, square: 1, epsilon: 2}

    def parameters(self, variants: Variants, off: frozenset[str]) -> np.ndarray:
        """Numbers of variants, (numbers, variants), for their direction of motion.

        Parameters
        ----------
        variants : Variants
        off : frozenset of str
            Actions that are off.
        """
        tabulation = self._tabulation
        made = tabulation.parameters(variants.numbers, variants.direction, variants.ends)
        rows = tabulation.functions.rows
        for node in tabulation.given:
            if node in self._sizes:
                action, coefficient = self._sizes[node]
                made[rows[node]] = 0.0 if action in off else made[rows[coefficient]]
            elif node is self._facing:
                made[rows[node]] = variants.direction * np.sign(variants.numbers["input.speed"])
            elif node not in self._moving:
                made[rows[node]] = 0.0
        return made

    def wheel(self, variants: Variants) -> np.ndarray:
        """Inertia by which an acceleration of the crank turns the frame through the flywheel, (variants,) [kg·m²].

        The wheel's shaft, `ratio` times as fast as the crank, has the inertia I/ratio² and the acceleration ratio·ε.
        """
        made = self.scene.flywheel
        ratio = variants.numbers["flywheel.wheel.ratio"] if made is not None and made.wheel is not None else 1.0
        return variants.flywheel / ratio

    def __call__(
        self,
        parameters: np.ndarray,
        wheel: np.ndarray,
        places: np.ndarray,
        omega: np.ndarray,
        epsilon: np.ndarray,
        clock: np.ndarray,
    ) -> dict[str, np.ndarray]:
        """The fields at given instants of a motion, each (instants, columns).

        Parameters
        ----------
        parameters : ndarray (numbers, columns)
            From `parameters`, for the direction and the variant of each column.
        wheel : ndarray (columns,)
            From `wheel` [kg·m²].
        places : ndarray (instants, columns)
            Crank angles [rad].
        omega : ndarray (instants, columns)
            Magnitude of the speed [rad/s].
        epsilon : ndarray (instants, columns)
            Acceleration, counter-clockwise positive [rad/s²].
        clock : ndarray (instants, columns)
            Time, for loads that depend on it [s].
        """
        tabulation = self._tabulation
        moving = (omega, omega * omega, epsilon)
        given = {node: moving[row] for node, row in self._moving.items() if node in tabulation.given}
        known = {*self._sizes, *self._moving, self._facing}
        given |= {node: clock for node in tabulation.given if node not in known}
        found = tabulation(parameters, places, given)
        fields = {name: found[row] for name, row in self._rows.items()}
        for name in WITH_FLYWHEEL:
            if name in fields:
                fields[name] = fields[name] - wheel * epsilon
        return fields


def _shaking(kinematics: Kinematics, motion: InputMotion) -> dict[str, Node]:
    """Shaking force and moment: of the accelerations ω² r″ plus ε r′."""
    second = shaking(kinematics, lambda point: point.a, lambda link: link.e)
    first = shaking(kinematics, lambda point: point.v, lambda link: link.w)

    force = motion.acceleration(second.force, first.force)
    return {
        "shaking_force_x": force.x,
        "shaking_force_y": force.y,
        "shaking_force": force.length,
        "shaking_moment": motion.acceleration(second.moment, first.moment),
    }
