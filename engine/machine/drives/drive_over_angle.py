"""A motor, an elastic shaft and a machine over the crank angle, as a system of rates.

With the machine's crank angle φ₂ as the independent variable, S = k(φ₁ − φ₂) the elastic torque of the shaft, ω₁ the
motor's speed and E = ½I(φ₂)ω₂² the machine's energy, the equations of motion

    I₁ φ̈₁ = M_m(φ̇₁) − T,   I(φ₂) φ̈₂ + ½ I′(φ₂) φ̇₂² = T + M(φ₂, φ̇₂),   T = S + b(φ̇₁ − φ̇₂)

become S′ = k(ω₁/ω₂ − 1), ω₁′ = (M_m − T)/(I₁ω₂), E′ = T + M. No derivative of I is needed.
"""

from typing import NamedTuple

from engine.graph.derivatives import derivative
from engine.graph.nodes import Given, Stage
from engine.mechanism.mechanics import Mechanics
from engine.motion.one_speed import SLOPES, Sizes, inertia_with_flywheel, moments_of, sizes_of
from engine.stepping.system import System


class DriveSizes(NamedTuple):
    """Numbers given to the system: of the machine, of its motors, and of the shaft, all reduced to the crank.

    Attributes
    ----------
    machine, motors : Sizes
    stiffness, damping, motor_inertia : Given
        [N·m/rad], [N·m·s/rad], [kg·m²].
    """

    machine: Sizes
    motors: Sizes
    stiffness: Given
    damping: Given
    motor_inertia: Given


def drive_over_angle(mechanics: Mechanics, motors: frozenset[str], loads: frozenset[str]) -> tuple[System, DriveSizes]:
    """The equations of motion, with the integrals of time, of the shaft's torque over time, and of the powers.

    Parameters
    ----------
    mechanics : Mechanics
    motors, loads : frozenset of str
        Actions at the motor end, and those on the machine.
    """
    graph = mechanics.graph
    labels = ("elastic torque", "speed at the motor end", "kinetic energy")
    states = elastic, motor_speed, energy = tuple(graph.given(label, Stage.STATE) for label in labels)
    names = ("stiffness", "damping", "motor_inertia")
    stiffness, damping, motor_inertia = shaft = tuple(graph.given(f"drive: {name}", Stage.VARIANT) for name in names)
    speed = graph.function("sqrt", energy * (2.0 / inertia_with_flywheel(mechanics)[0]))
    of_machine, clock, machine_sizes = sizes_of(mechanics, speed)
    at_end, _, motor_sizes = sizes_of(mechanics, motor_speed, "shaft: ")
    load = moments_of(mechanics, of_machine, machine_sizes, speed, motors).total
    motor = moments_of(mechanics, at_end, motor_sizes, motor_speed, loads).total
    slip, pace = motor_speed - speed, 1.0 / speed
    moment = elastic + damping * slip
    rates = stiffness * slip * pace, (motor - moment) / motor_inertia * pace, moment + load
    slopes = tuple(derivative(rate, {state: graph.one}, SLOPES) for rate in rates for state in states)
    gathered = {"period": pace, "motor_work": motor * motor_speed * pace, "load_work": load}
    gathered |= {"damping_work": damping * slip * slip * pace, "impulse": moment * pace}
    # Collocation solves it, not a walk, so the slope of the speed is not read.
    system = System(
        "angle", states, rates=rates, speed=speed, slope=graph.zero, clock=clock, gathered=gathered, slopes=slopes
    )
    return system, DriveSizes(machine_sizes, motor_sizes, *shaft)
