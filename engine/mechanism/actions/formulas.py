"""Loads given by formulas, as nodes: the formula is computed as written, with its switching parts held.

A part that switches (a sign, a minimum, a comparison) does so where a curve crosses a level; panels end there. The
derivative of that curve with respect to the input follows from the formula's structure, by the rules of
differentiation.
"""

import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Held, Node, Return, Stage, reached
from engine.laws.elementary import angle_of, direction_of, exponential, logarithm, power
from engine.laws.senses import angle_on_side, either, exceeds, kept_positive, quotient, sense, side
from engine.laws.tables import cycles_before
from engine.mechanism.actions.paths import Along, input_sense, time_per_input, uniform_time
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Characteristic
from engine.parts.formulas.expressions import TextOperation, TextQuantity, Tree, evaluate_tree, names_in_tree
from engine.parts.formulas.speed_powers import NoPowerError, powers_of_speed
from engine.parts.skeleton import CrankInput
from engine.scene.load_formulas import TIME, LoadFormula

# Integer exponents up to this one are computed by multiplication.
LARGEST_PRODUCT = 16


class Differentiated(NamedTuple):
    """A quantity along the motion, and its derivative with respect to the input."""

    value: Node
    rate: Node


def formula_characteristics(
    kinematics: Kinematics, formula: LoadFormula, along: Along, factor: Node, time: Node, speed: Node | None
) -> Iterator[Characteristic]:
    """Magnitude of a load by a formula: a characteristic for each power of the input speed.

    A formula that is not a sum of such powers becomes one characteristic, which depends on the speed itself.

    Parameters
    ----------
    kinematics : Kinematics
    formula : LoadFormula
    along : Along
        Motion of the loaded point or link.
    factor : Node
        Held factor of the value.
    time : Node
        [s].
    speed : Node or None
        Magnitude of the input speed [rad/s]; None for the scene's speed.
    """
    graph, tree = kinematics.graph, formula.expression.tree
    forward = input_sense(kinematics)
    try:
        parts, signed = powers_of_speed(tree, formula.velocities), forward
    except NoPowerError:
        parts, signed = {Fraction(0): tree}, graph.number("input.speed") if speed is None else forward * speed
    if along.direction is not None and formula.action.angle is None:
        # Along the motion, in whichever direction the input moves.
        factor = factor * forward
    curves = _Curves(kinematics, formula, along, signed, time)
    for exponent, part in parts.items():
        order = int(exponent) if exponent in (0, 1, 2) else float(exponent)
        size = graph.derived(f"{formula.at} over speed^{order}", _speed_to(order))
        yield Characteristic(size, curves.of(part).value * factor, order)


def _speed_to(order: float) -> Callable:
    return lambda numbers: np.abs(numbers["input.speed"]) ** order


class _Curves:
    """The parts of a formula as curves; velocities refer to `speed`."""

    def __init__(self, kinematics: Kinematics, formula: LoadFormula, along: Along, speed: Node, time: Node) -> None:
        self.kinematics, self.graph, self.formula = kinematics, kinematics.graph, formula
        self.along, self.speed, self.time = along, speed, time
        # Parts are shared, so each is converted once. Keeping the tree keeps its id valid.
        self._known: dict[int, tuple[Tree, Differentiated]] = {}
        self._names: dict[str, Differentiated] = {}
        # Curves with the same zeros, stripped of numeric factors and powers.
        self._bare: dict[Node, Differentiated] = {}
        # Distances from an end of a stroke: the slide, the sign with which they grow with it, and the end.
        self._distances: dict[Node, tuple[Differentiated, float, Node]] = {}

    def of(self, tree: Tree) -> Differentiated:
        """A part of the formula with its derivative."""
        if id(tree) not in self._known:
            self._known[id(tree)] = tree, self._found(tree)
        return self._known[id(tree)][1]

    def _found(self, tree: Tree) -> Differentiated:
        if isinstance(tree, str):
            return self._named(tree)
        if isinstance(tree, float):
            return self._constant(tree)
        if isinstance(tree, TextQuantity):
            return self._constant(tree.value)
        if not names_in_tree(tree):
            return self._constant(evaluate_tree(tree, {}).item())
        if tree.name == "if":
            condition, *choices = tree.operands
            return self._either(self._condition(condition), *(self.of(choice) for choice in choices))
        if tree.name == "**":
            return self._power(*tree.operands)
        if tree.name == "sqrt":
            return self._root(*tree.operands)
        if tree.name in ("sin", "cos", "tan"):
            return self._of_angle(tree.name, tree.operands[0])
        if tree.name in ("min", "max"):
            return self._chosen(tree.name == "max", *(self.of(operand) for operand in tree.operands))
        if tree.name in _FACTORS:
            return self._product(self._constant(_FACTORS[tree.name]), self.of(*tree.operands))
        return getattr(self, _METHODS[tree.name])(*(self.of(operand) for operand in tree.operands))

    def _constant(self, value: float) -> Differentiated:
        return Differentiated(self.graph.constant(value), self.graph.zero)

    # Arithmetic

    def _sum(self, a: Differentiated, b: Differentiated) -> Differentiated:
        return Differentiated(a.value + b.value, a.rate + b.rate)

    def _difference(self, a: Differentiated, b: Differentiated) -> Differentiated:
        return Differentiated(a.value - b.value, a.rate - b.rate)

    def _product(self, a: Differentiated, b: Differentiated) -> Differentiated:
        found = Differentiated(a.value * b.value, a.rate * b.value + a.value * b.rate)
        for number, curve in ((a, b), (b, a)):
            if number.value.stage < Stage.POSITION:
                self._bare[found.value] = self._bare.get(curve.value, curve)
        return found

    def _quotient(self, a: Differentiated, b: Differentiated) -> Differentiated:
        if b.value.stage < Stage.POSITION:
            found = a.value / b.value
        else:
            # A panel ends at a pole, so the pole can't pass unseen between two positions.
            found = self.graph.apply(quotient, self._held_sign(sense, b), *a, *b)
        return Differentiated(found, (a.rate - found * b.rate) / b.value)

    def _power(self, base: Tree, exponent: Tree) -> Differentiated:
        if names_in_tree(exponent):
            return self._varying_power(base, self.of(exponent))
        n = evaluate_tree(exponent, {}).item()
        if n == 0.5:
            return self._root(base)
        if n != int(n) or abs(n) > LARGEST_PRODUCT:
            return self._varying_power(base, self._constant(n))
        x = self.of(base)
        if n == 0:
            return self._constant(1.0)
        if n < 0:
            inverse = self._quotient(self._constant(1.0), x).value
            value = self._multiplied(inverse, abs(int(n)))
            return Differentiated(value, n * (value * inverse) * x.rate)
        value = self._multiplied(x.value, int(n))
        self._bare[value] = self._bare.get(x.value, x)
        return Differentiated(value, n * (value / x.value) * x.rate)

    def _multiplied(self, x: Node, times: int) -> Node:
        if times < 2:
            return x if times else self.graph.one
        half = self._multiplied(x, times // 2)
        return half * half * x if times % 2 else half * half

    def _varying_power(self, base: Tree, n: Differentiated) -> Differentiated:
        x = self._not_negative(base)
        value = self.graph.apply(power, x.value, n.value)
        grown = n.value * self.graph.apply(power, x.value, n.value - 1.0) * x.rate
        if n.rate is not self.graph.zero:
            grown = grown + value * self.graph.apply(logarithm, x.value) * n.rate
        return Differentiated(value, grown)

    def _not_negative(self, tree: Tree) -> Differentiated:
        """Argument of a root or a fractional power: rounding may make a vanishing one negative."""
        if isinstance(tree, TextOperation) and tree.name == "abs":
            return Differentiated(abs(self.of(tree.operands[0]).value), self.of(tree).rate)
        x = self.of(tree)
        if x.value.stage < Stage.POSITION:
            return x
        return Differentiated(self.graph.apply(kept_positive, self._held_sign(sense, x), x.value), x.rate)

    # Functions

    def _root(self, square: Tree) -> Differentiated:
        x = self._not_negative(square)
        value = self.graph.function("sqrt", x.value)
        return Differentiated(value, x.rate / (2.0 * value))

    def _exponential(self, x: Differentiated) -> Differentiated:
        value = self.graph.apply(exponential, x.value)
        return Differentiated(value, value * x.rate)

    def _logarithm(self, x: Differentiated) -> Differentiated:
        return Differentiated(self.graph.apply(logarithm, x.value), x.rate / x.value)

    def _of_angle(self, name: str, angle: Tree) -> Differentiated:
        """Sine, cosine or tangent; an angle that makes whole turns per cycle continues beyond the cycle's end."""
        graph = self.graph
        if angle == "phi":
            x, cosine, sine = Differentiated(graph.q, graph.one), graph.cos_q, graph.sin_q
        else:
            timed = self._follows_time(angle)
            x = self._unfolded(angle) if timed or self._turns_wholly(angle) else self.of(angle)
            cosine, sine = graph.apply(direction_of, x.value)
            if timed and x.rate.stage == Stage.VARIANT and not any(isinstance(n, Held) for n in reached([x.value])):
                # Periodic if the cycle is a multiple of its period.
                graph.returns((cosine, sine), Return(TIME, x.rate * float(self._revolutions)))
        if name == "sin":
            return Differentiated(sine, cosine * x.rate)
        if name == "cos":
            return Differentiated(cosine, -sine * x.rate)
        return self._quotient(Differentiated(sine, cosine * x.rate), Differentiated(cosine, -sine * x.rate))

    def _follows_time(self, angle: Tree) -> bool:
        """Whether a part depends on the time of a cycle at constant speed."""
        uniform = self.kinematics.has_cycle and self.time is uniform_time(self.kinematics)
        return uniform and TIME in names_in_tree(angle)

    def _turns_wholly(self, angle: Tree) -> bool:
        slope = self._slope(angle) if "phi" in names_in_tree(angle) else None
        return slope is not None and (slope * self._revolutions).is_integer()

    def _slope(self, tree: Tree) -> float | None:
        """Derivative of a part with respect to phi if the part is linear in phi, else None."""
        if tree == "phi":
            return 1.0
        if isinstance(tree, TextOperation) and tree.name in ("+", "-", "*", "/", "negative"):
            slopes = [self._slope(operand) for operand in tree.operands]
            if None in slopes:
                return None
            match tree.name:
                case "+":
                    return slopes[0] + slopes[1]
                case "-":
                    return slopes[0] - slopes[1]
                case "negative":
                    return -slopes[0]
            still = [not names_in_tree(operand) for operand in tree.operands]
            if not any(slopes):
                return 0.0
            if tree.name == "*" and any(still):
                number, angle = (0, 1) if still[0] else (1, 0)
                return slopes[angle] * evaluate_tree(tree.operands[number], {}).item()
            return slopes[0] / evaluate_tree(tree.operands[1], {}).item() if tree.name == "/" and still[1] else None
        names = names_in_tree(tree)
        return 0.0 if all(self._named(name).value.stage < Stage.POSITION for name in names) else None

    def _unfolded(self, angle: Tree) -> Differentiated:
        """An angle that contains the crank angle and continues from one cycle to the next."""
        unfolded = _Curves(self.kinematics, self.formula, self.along, self.speed, self.time)
        unfolded._names["phi"] = Differentiated(self.graph.q, self.graph.one)
        return unfolded.of(angle)

    def _arcsine(self, x: Differentiated) -> Differentiated:
        cosine = self.graph.function("sqrt", (1.0 - x.value) * (1.0 + x.value))
        return Differentiated(self.graph.apply(angle_of, cosine, x.value), x.rate / cosine)

    def _arccosine(self, x: Differentiated) -> Differentiated:
        sine = self.graph.function("sqrt", (1.0 - x.value) * (1.0 + x.value))
        return Differentiated(self.graph.apply(angle_of, x.value, sine), -x.rate / sine)

    def _arctangent(self, x: Differentiated) -> Differentiated:
        return Differentiated(self.graph.apply(angle_of, 1.0, x.value), x.rate / (1.0 + x.value * x.value))

    def _direction(self, y: Differentiated, x: Differentiated) -> Differentiated:
        """Angle of a vector; it jumps where the vector points along −x."""
        if max(x.value.stage, y.value.stage) < Stage.POSITION:
            return Differentiated(self.graph.apply(angle_of, x.value, y.value), self.graph.zero)
        above = self._held_sign(side, y)
        value = self.graph.apply(angle_on_side, above, x.value, y.value)
        return Differentiated(value, (x.value * y.rate - y.value * x.rate) / (x.value * x.value + y.value * y.value))

    # Switching

    def _held_sign(self, law: Callable, x: Differentiated) -> Node:
        """Held sign or side of a quantity; a switching event is registered."""
        curve = self._bare.get(x.value, x)
        self.graph.switches(*curve)
        return self.graph.held(self.graph.apply(law, x.value))

    def _sign(self, x: Differentiated) -> Differentiated:
        return Differentiated(self._held_sign(sense, x), self.graph.zero)

    def _magnitude(self, x: Differentiated) -> Differentiated:
        if x.value.stage < Stage.POSITION:
            return Differentiated(abs(x.value), self.graph.zero)
        forward = self._held_sign(sense, x)
        return Differentiated(forward * x.value, forward * x.rate)

    def _chosen(self, greatest: bool, found: Differentiated, *others: Differentiated) -> Differentiated:
        for other in others:
            choices = (found, other) if greatest else (other, found)
            found = self._either(self._exceeds(found, other), *choices)
        return found

    def _either(self, condition: Node, a: Differentiated, b: Differentiated) -> Differentiated:
        value, rate = (x if x is y else self.graph.apply(either, condition, x, y) for x, y in zip(a, b, strict=True))
        return Differentiated(value, rate)

    def _condition(self, tree: TextOperation) -> Node:
        """1 where a condition holds, else 0."""
        if tree.name in ("and", "or", "not"):
            parts = [self._condition(part) for part in tree.operands]
            found = parts[0] if tree.name == "and" else 1.0 - parts[0]
            for part in parts[1:]:
                found = found * (part if tree.name == "and" else 1.0 - part)
            return 1.0 - found if tree.name == "or" else found
        a, b = (self.of(operand) for operand in tree.operands)
        exceeds = self._exceeds(a, b) if tree.name in (">", "<=") else self._exceeds(b, a)
        return exceeds if tree.name in (">", "<") else 1.0 - exceeds

    def _exceeds(self, a: Differentiated, b: Differentiated) -> Node:
        """1 where a exceeds b, else 0; held, with a switching event."""
        graph, zero = self.graph, self.graph.zero
        # A level that another part of the formula switches has jumps.
        if min(a.value.stage, b.value.stage) > Stage.CYCLE:
            a, b = self._difference(a, b), Differentiated(zero, zero)
        curve, level = (a, b.value) if a.value.stage == Stage.POSITION else (b, a.value)
        if level is zero:
            curve = self._bare.get(curve.value, curve)
        if curve.value in self._distances:
            # The slide is known before the ends of its stroke are.
            curve, sign, end = self._distances[curve.value]
            level = end + sign * level
        graph.switches(*curve, level)
        return graph.held(graph.apply(exceeds, a.value, b.value))

    # Names

    def _named(self, name: str) -> Differentiated:
        if name not in self._names:
            self._names[name] = self._of_name(name)
        return self._names[name]

    def _of_name(self, name: str) -> Differentiated:
        numbers, k = self.formula.action.numbers, self.kinematics
        if name in numbers:
            return self._number(f"{self.formula.at}.numbers.{name}")
        match name:
            case "phi":
                return self._crank_angle()
            case "v":
                along = self._at_speed(Differentiated(self.along.velocity, self.along.slope))
                return self._product(self._forward, along) if self.formula.action.angle is None else along
            case "omega":
                on = self.formula.action.on
                link = k.links[on if self.along.direction is None else k.scene.input.link]
                return self._at_speed(Differentiated(link.w, link.e))
        if name == TIME:
            return Differentiated(self.time, time_per_input(k))
        owner, _, quantity = name.rpartition(".")
        if owner in k.slides and quantity in _OF_SLIDE:
            return self._of_slider(owner, quantity)
        if owner in k.points and quantity in _OF_POINT:
            point, axis = k.points[owner], "xy".index(quantity[-1])
            if quantity[0] == "v":
                return self._at_speed(Differentiated(point.v[axis], point.a[axis]))
            return Differentiated(k.coordinates(point.r)[axis], point.v[axis])
        if owner in k.links and quantity == "angular_velocity":
            return self._at_speed(Differentiated(k.links[owner].w, k.links[owner].e))
        if owner in k.links and quantity == "angle":
            return self._link_angle(owner)
        return self._number(name)

    def _number(self, path: str) -> Differentiated:
        # As array elements: division by 0 is then infinite.
        number = self.graph.derived(f"{path} in formulas", lambda n: np.float64(1.0) * n[path])
        return Differentiated(number, self.graph.zero)

    def _at_speed(self, transfer: Differentiated) -> Differentiated:
        """Velocity from its transfer function, with which it shares its zeros."""
        found = self._product(Differentiated(self.speed, self.graph.zero), transfer)
        self._bare[found.value] = self._bare.get(transfer.value, transfer)
        return found

    @property
    def _forward(self) -> Differentiated:
        return Differentiated(input_sense(self.kinematics), self.graph.zero)

    @property
    def _revolutions(self) -> int:
        return self.kinematics.scene.input.revolutions

    def _crank_angle(self) -> Differentiated:
        """Crank angle within a cycle if the crank turns fully: it restarts at 0 after each cycle."""
        graph, drive = self.graph, self.kinematics.scene.input
        if drive.start is not None:
            return Differentiated(graph.q, graph.one)
        graph.switches(graph.q, graph.one)
        before = graph.apply(cycles_before, math.tau * drive.revolutions, graph.q)
        return Differentiated(graph.q - graph.held(before), graph.one)

    def _link_angle(self, name: str) -> Differentiated:
        link, drive = self.kinematics.links[name], self.kinematics.scene.input
        if name == drive.link and isinstance(drive, CrankInput):
            return self._named("phi")
        turned = self._direction(
            Differentiated(link.u.y, link.w * link.u.x), Differentiated(link.u.x, -link.w * link.u.y)
        )
        return Differentiated(turned.value, link.w)

    def _of_slider(self, name: str, quantity: str) -> Differentiated:
        graph, slide, zero = self.graph, self.kinematics.slides[name], self.graph.zero
        low, high = (graph.found(slide.d, slide.v, which) for which in ("low", "high"))
        coordinate = Differentiated(slide.d, slide.v)
        match quantity:
            case "slide":
                return coordinate
            case "velocity":
                return self._at_speed(Differentiated(slide.v, slide.a))
            case "from_low":
                found, *from_end = Differentiated(slide.d - low, slide.v), 1.0, low
            case "from_high":
                found, *from_end = Differentiated(high - slide.d, -slide.v), -1.0, high
            case _:
                ends = {"stroke": high - low, "stroke_low": low, "stroke_high": high}
                return Differentiated(ends[quantity], zero)
        self._distances[found.value] = coordinate, *from_end
        return found


_OF_SLIDE = ("slide", "velocity", "stroke", "stroke_low", "stroke_high", "from_low", "from_high")
_OF_POINT = ("x", "y", "vx", "vy")
_FACTORS = {"negative": -1.0, "radians": math.pi / 180.0, "degrees": 180.0 / math.pi}
_METHODS = {
    "+": "_sum",
    "-": "_difference",
    "*": "_product",
    "/": "_quotient",
    "exp": "_exponential",
    "log": "_logarithm",
    "asin": "_arcsine",
    "acos": "_arccosine",
    "atan": "_arctangent",
    "atan2": "_direction",
    "sign": "_sign",
    "abs": "_magnitude",
}
