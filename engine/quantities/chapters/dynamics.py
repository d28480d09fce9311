"""Reduced inertia and moments, the mean drive torque, and the flywheel by three methods.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on reduction, on the motion of a machine and on
flywheels.
"""

from functools import partial

from engine import mechanism
from engine.graph.nodes import Node
from engine.mechanism.input_motion import multiple_angle
from engine.mechanism.mechanics import Mechanics
from engine.parts.bodies import OF_FLUCTUATION
from engine.quantities.expressions import (
    Expression,
    Integral,
    Speed,
    SteadyCycle,
    Unbalanced,
    VariantNumber,
    Work,
    hypot,
    peak,
    share,
    unresolved_peak,
)
from engine.quantities.register import (
    Declared,
    Field,
    InputUnits,
    Summary,
    answer_summary,
    check_summary,
    detail,
    drive_words,
    mean,
    ranked_summary,
)
from engine.scene.pairs import has_friction
from engine.words.quantity import called, ordinal

_USEFUL = frozenset({"useful"})
# Highest harmonic of the drive torque over the cycle.
HARMONICS = 12


def is_loaded(mechanics: Mechanics) -> bool:
    """Whether the machine has masses or loads, so that results beyond kinematics are of interest."""
    return bool(mechanics.scene.bodies or mechanics.loads.actions)


def declare(mechanics: Mechanics) -> Declared:
    """Inertia, moments, drive torque and, over a cycle, the flywheel."""
    m, scene, graph = mechanics, mechanics.scene, mechanics.graph
    u = InputUnits.of(scene)
    at, _, load = u.symbols
    without = ", without friction in pairs" if has_friction(scene) else ""
    yield Field("reduced_inertia", "reduced moment of inertia", u.inertia, lambda: m.reduced.inertia, "I")
    words, units = "derivative of the reduced moment of inertia with respect to the input", f"{u.inertia} {u.per_q}"
    yield detail("reduced_inertia_phi", words, units, lambda: m.reduced.slope, f"dI/d{at}")
    words = f"reduced moment of all loads except the drive{without}"
    yield Field("reduced_moment", words, u.moment, m.moment_of, load)
    asked = ("peak",) if is_loaded(m) else ()
    words = f"{drive_words(m.scene)}{without}"
    yield Field("input_moment", words, u.moment, lambda: m.input_moment, f"{load}_in", asked)
    for action in m.loads.actions:
        terms = [(t.coefficient, t.basis) for t in m.loads.terms if t.action == action]
        words = f"reduced moment of {action}"
        yield Field(f"{action}.moment", words, u.moment, partial(graph.combination, terms), f"{load}_{action}")
    words = "constant part of the reduced moment of inertia"
    yield Summary("first_kind_inertia", words, u.inertia, lambda: VariantNumber(m.reduced.first_kind), "I_0")
    if m.loads.motors:
        for name in m.loads.motors:
            if getattr(scene.moments[name], "rated_speed", None) is None:
                continue
            power, speed = f"moments.{name}.power", f"moments.{name}.rated_speed"
            rated = graph.derived(f"rated torque of {name}", lambda n, p=power, w=speed: n[p] / n[w])
            words = f"rated torque of {called('motor', name)}, at its own shaft"
            yield answer_summary(f"{name}.rated_moment", words, "N m", partial(VariantNumber, rated))
        moment_of = mechanism.actions.motors.motor_moment
        number = graph.derived("motor moment", lambda n: moment_of(scene, m.loads.motors, n))
        words = "torque of the motors at the input speed, reduced to the input"
        yield Summary("motor_moment", words, "N m", lambda: VariantNumber(number))
    if m.has_cycle:
        yield from _orders(m, u.moment)
        yield from _drive(m)
        yield from _flywheel(m)


def _orders(m: Mechanics, units: str) -> Declared:
    """Orders of the drive torque, in multiples of the crank speed; half orders too if a cycle is two revolutions."""
    for k in range(1, HARMONICS + 1):
        order = f"{k / m.scene.input.revolutions:g}"
        words = f"{ordinal(order)}-order amplitude of the drive torque"
        name = f"input_moment.order_{order.replace('.', '_')}"
        yield Summary(name, words, units, lambda k=k: hypot(*input_moment_harmonic(m, k)))


def input_moment_harmonic(m: Mechanics, k: int) -> tuple[Expression, Expression]:
    """Cosine and sine coefficient of a harmonic of the drive torque, 2/T ∫ M_in cos(2πkφ/T) dφ and so on.

    Parameters
    ----------
    m : Mechanics
        With a cycle.
    k : int
        At least 1.
    """
    half = VariantNumber(m.last - m.first) / 2.0
    turned = multiple_angle(m.graph, k, m.scene.input.revolutions)
    cosine, sine = (Integral(m.input_moment * part) / half for part in turned)
    return cosine, sine


def _drive(m: Mechanics) -> Declared:
    """The mean drive torque."""

    def resisting() -> Expression:
        return -mean(m, m.moment_of())

    def unbalanced() -> Expression:
        return share(Unbalanced(m.reduced.inertia, m.reduced.slope), peak(m.reduced.inertia))

    def net_work() -> Expression:
        return share(abs(mean(m, m.conservative_moment)), unresolved_peak(m.conservative_moment))

    words = "mean torque of the useful resistances over the cycle, reduced to the input"
    yield Summary("mean_useful_moment", words, "N m", lambda: -mean(m, m.moment_of(_USEFUL)))
    summary = ranked_summary(is_loaded(m))
    yield summary("required_drive_moment", "mean drive torque", "N m", resisting, "M_d")
    yield summary("required_power", "mean drive power", "W", lambda: resisting() * VariantNumber(m.speed), "P")
    energies = "kinetic energy at constant speed and the work of the inertia forces"
    words = f"maximum difference between {energies}, relative to the peak energy"
    yield check_summary("power_balance_residual", words, "1", unbalanced)
    if m.conservative_moment is not m.graph.zero:
        words = "net work of gravity and springs over the cycle, relative to their peak moment times the angle"
        yield check_summary("conservative_work_residual", words, "1", net_work)


def _flywheel(m: Mechanics) -> Declared:
    """Excess work, and the results for the flywheel."""
    flywheel = m.scene.flywheel
    asked = flywheel is not None and flywheel.speed_fluctuation is not None
    given = flywheel is not None and flywheel.inertia is not None

    steady = partial(steady_cycle, m)
    words = "work of all moments with a constant drive torque: change of kinetic energy"
    yield Field("work", words, "J", lambda: Work(m.moment_of()), "W")
    yield ranked_summary(is_loaded(m))("excess_work", "excess work", "J", partial(steady, "excess_work"), "A_exc")
    if asked:
        for name, words in (
            ("flywheel_excess_work", "flywheel inertia by the excess work"),
            ("flywheel_merzalov", "flywheel inertia by Merzalov's method"),
            ("flywheel_wittenbauer", "flywheel inertia by Wittenbauer's method, exact"),
        ):
            yield Summary(name, words, "kg m2", partial(steady, name), "I_F")
        for name, method in (("excess_work", "excess work"), ("merzalov", "Merzalov")):
            words = f"flywheel by {method}, relative difference from the exact result"
            yield check_summary(f"{name}_difference", words, "1", partial(_from_exact, m, f"flywheel_{name}"))
    if asked or given:
        words = "flywheel inertia on the input link: as given, or by Wittenbauer's method"
        yield answer_summary("flywheel_used", words, "kg m2", partial(steady, "flywheel_used"))
        words = f"coefficient of speed fluctuation with the flywheel, {OF_FLUCTUATION}"
        yield answer_summary("speed_fluctuation", words, "1", partial(steady, "speed_fluctuation"), "δ")
        words = "angular speed of the input link with the flywheel, by magnitude"
        yield Field("speed", words, "rad s-1", lambda: Speed(steady("")), "ω")
        for name, word in (("speed_min", "minimum"), ("speed_max", "maximum")):
            symbol = name.replace("speed", "ω")
            yield Summary(name, f"{word} {words}", "rad s-1", partial(steady, name), symbol)


def _from_exact(m: Mechanics, method: str) -> Expression:
    return steady_cycle(m, method) / steady_cycle(m, "flywheel_wittenbauer") - 1.0


def steady_cycle(m: Mechanics, result: str) -> SteadyCycle:
    """A result of the steady cycle with the flywheel of the scene."""
    flywheel = m.scene.flywheel

    def number(key: str) -> Node | None:
        given = flywheel is not None and getattr(flywheel, key) is not None
        return m.graph.number(f"flywheel.{key}") if given else None

    fluctuation, wheel = number("speed_fluctuation"), number("inertia")
    return SteadyCycle(m.reduced.inertia, m.moment_of(), m.speed, fluctuation, m.reduced.first_kind, wheel, result)
