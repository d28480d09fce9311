"""The flywheel that keeps a machine's speed within a coefficient of fluctuation δ, by three methods.

Over the cycle the work of the torque about its mean is W(φ), and the reduced inertia of the mechanism alone I(φ). A
flywheel J stores the rest. `energy` is δ ω². Only arithmetic is used, so that numbers may carry error estimates.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on flywheels (methods of Merzalov and
Wittenbauer).
"""

from typing import TypeVar

Value = TypeVar("Value")


def flywheel_by_excess_work(excess_work: Value, energy: Value) -> Value:
    """J = (W_max − W_min)/(δ ω²): the whole reduced inertia, taken as constant [kg·m²]."""
    return excess_work / energy


def flywheel_by_merzalov(energy_range: Value, energy: Value, constant_inertia: Value) -> Value:
    """Flywheel by Merzalov [kg·m²]: the energy of the constant part of I changes by W − ½ ω² I, at the mean speed.

    Parameters
    ----------
    energy_range : Measured or float
        Range of W − ½ ω² I over the cycle [J].
    energy : Measured or float
        δ ω².
    constant_inertia : Measured or float
        Constant part of I, which already does a share of the flywheel's work [kg·m²].
    """
    return energy_range / energy - constant_inertia


def flywheel_by_wittenbauer(greatest: Value, least: Value, energy: Value, first_inertia: Value) -> Value:
    """Flywheel by Wittenbauer [kg·m²], exact: the tangents to the diagram of energy over inertia at ω_max and ω_min.

    Parameters
    ----------
    greatest, least : Measured or float
        Maximum of W − ½ ω_max² I, minimum of W − ½ ω_min² I [J]; I counts from its value at the start.
    energy : Measured or float
        δ ω².
    first_inertia : Measured or float
        I at the start [kg·m²].
    """
    return (greatest - least) / energy - first_inertia
