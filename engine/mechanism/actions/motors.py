"""The motors of a scene: their torque reduced to the input link."""

from collections import defaultdict

import numpy as np

from engine.graph.nodes import Node
from engine.laws.loads import sized
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Grip, Load
from engine.parts.motors import Motor, MotorCurve
from engine.parts.skeleton import FRAME
from engine.scene.scene import Numbers, Scene


def motor_moment(scene: Scene, motors: tuple[str, ...], numbers: Numbers) -> float | np.ndarray:
    """Torque of the motors at the input speed, reduced to the input link [N·m], for every variant."""
    total: float | np.ndarray = 0.0
    for name in motors:
        motor = scene.moments[name]
        ratio = motor_ratio(scene, motor, numbers)
        # A motor drives its shaft in the direction in which the shaft is meant to turn.
        moment = motor.curve(f"moments.{name}", numbers).moment(np.abs(numbers["input.speed"] * ratio))
        total = total + moment * np.abs(ratio) * np.sign(numbers["input.speed"])
    return total


def motor_at_speed(kinematics: Kinematics, name: str, on: Node, facing: Node, speed: Node) -> Node:
    """Torque of a motor at the speed of a state, reduced to the input, in the direction of motion [N·m].

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        A motor of the scene.
    on : Node
        1 while it is switched on, else 0.
    facing : Node
        +1 or −1: direction of motion relative to the direction in which the motor is meant to drive.
    speed : Node
        In the direction of motion [rad/s].
    """
    graph, scene, path = kinematics.graph, kinematics.scene, f"moments.{name}"
    motor = scene.moments[name]

    def constant(label: str, law: int, index: int) -> Node:
        return graph.derived(f"{label} of {path}", lambda n: motor.curve(path, n).constants[law][index])

    ratio = facing * graph.derived(f"ratio of {path}", lambda n: np.abs(motor_ratio(scene, motor, n)))
    # A motor's laws do not depend on its numbers.
    laws = motor.curve(path, defaultdict(lambda: np.nan)).laws
    moment = MotorCurve.of_nodes(laws, constant).moment(ratio * speed)
    return ratio * graph.apply(sized, on, moment)


def motor_on_shaft(kinematics: Kinematics, name: str, reduced: Node, way: Node) -> Load:
    """A motor's torque on its own shaft, from the reduced one in the direction of motion; its stator is on the frame.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        A motor of the scene.
    reduced : Node
        From `motor_at_speed`.
    way : Node
        +1 or −1: sense in which the input moves.
    """
    on, graph = kinematics.scene.moments[name].on, kinematics.graph
    rate = kinematics.links[on].w
    grip = Grip(on, None, None, (FRAME, kinematics.links[FRAME].origin))
    return Load(name, graph.one, way * reduced / rate, grip, rate, way * reduced, "driving", 0)


def motor_ratio(scene: Scene, motor: Motor, numbers: Numbers) -> float | np.ndarray:
    """Speed of a motor divided by that of the input link, with its sign."""
    ratio, on = 1.0, motor.on
    while on != scene.input.link:
        ratio, on = ratio * numbers[f"shafts.{on}.ratio"], scene.shafts[on].geared_to
    return ratio
