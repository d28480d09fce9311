"""Loads given by formulas, as nodes: the formula is computed as written, with its switching parts held.

A part that switches (a sign, a minimum, a comparison) does so where a curve crosses a level; panels end there. The
derivative of that curve with respect to the input follows from those of the names in the formula.
"""

import math
from collections.abc import Callable, Iterator
from fractions import Fraction

import numpy as np

from engine.graph.derivatives import derivative
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
from engine.scene.load_formulas import OF_POINT, OF_SLIDER, TIME, LoadFormula

# Integer exponents up to this one are computed by multiplication.
LARGEST_PRODUCT = 16


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
        yield Characteristic(size, curves.of(part) * factor, order)


def _speed_to(order: float) -> Callable:
    return lambda numbers: np.abs(numbers["input.speed"]) ** order


class _Curves:
    """The parts of a formula as curves; velocities refer to `speed`."""

    def __init__(self, kinematics: Kinematics, formula: LoadFormula, along: Along, speed: Node, time: Node) -> None:
        self.kinematics, self.graph, self.formula = kinematics, kinematics.graph, formula
        self.along, self.speed, self.time = along, speed, time
        # Parts are shared, so each is converted once. Keeping the tree keeps its id valid.
        self._known: dict[int, tuple[Tree, Node]] = {}
        self._names: dict[str, Node] = {}
        # Derivatives with respect to the input.
        graph = self.graph
        self._rates = {graph.q: graph.one, graph.cos_q: -graph.sin_q, graph.sin_q: graph.cos_q}
        # Curves with the same zeros, stripped of numeric factors and powers.
        self._bare: dict[Node, Node] = {}
        # Distances from an end of a stroke: the slide, the sign with which they grow with it, and the end.
        self._distances: dict[Node, tuple[Node, float, Node]] = {}

    def of(self, tree: Tree) -> Node:
        """A part of the formula."""
        if id(tree) not in self._known:
            self._known[id(tree)] = tree, self._found(tree)
        return self._known[id(tree)][1]

    def _rate(self, curve: Node) -> Node:
        """Derivative of a curve with respect to the input."""
        return derivative(curve, self._rates)

    def _with_rate(self, curve: Node, rate: Node) -> Node:
        """Give a curve its derivative with respect to the input."""
        self._rates[curve] = rate
        return curve

    def _found(self, tree: Tree) -> Node:
        if isinstance(tree, str):
            return self._named(tree)
        if isinstance(tree, float):
            return self.graph.constant(tree)
        if isinstance(tree, TextQuantity):
            return self.graph.constant(tree.value)
        if not names_in_tree(tree):
            return self.graph.constant(evaluate_tree(tree, {}).item())
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
            return self._product(self.graph.constant(_FACTORS[tree.name]), self.of(*tree.operands))
        return _METHODS[tree.name](self, *(self.of(operand) for operand in tree.operands))

    # Arithmetic

    def _product(self, a: Node, b: Node) -> Node:
        found = a * b
        for number, curve in ((a, b), (b, a)):
            if number.stage < Stage.POSITION:
                self._bare[found] = self._bare.get(curve, curve)
        return found

    def _quotient(self, a: Node, b: Node) -> Node:
        if b.stage < Stage.POSITION:
            return a / b
        # A panel ends at a pole, so the pole can't pass unseen between two positions.
        rates = self._rate(a), self._rate(b)
        found = self.graph.apply(quotient, self._held_sign(sense, b), a, rates[0], b, rates[1])
        return self._with_rate(found, (rates[0] - found * rates[1]) / b)

    def _power(self, base: Tree, exponent: Tree) -> Node:
        if names_in_tree(exponent):
            return self._varying_power(base, self.of(exponent))
        n = evaluate_tree(exponent, {}).item()
        if n == 0.5:
            return self._root(base)
        if n != int(n) or abs(n) > LARGEST_PRODUCT:
            return self._varying_power(base, self.graph.constant(n))
        x = self.of(base)
        if n < 0:
            return self._multiplied(self._quotient(self.graph.one, x), abs(int(n)))
        value = self._multiplied(x, int(n))
        if n > 0:
            self._bare[value] = self._bare.get(x, x)
        return value

    def _multiplied(self, x: Node, times: int) -> Node:
        if times < 2:
            return x if times else self.graph.one
        half = self._multiplied(x, times // 2)
        return half * half * x if times % 2 else half * half

    def _varying_power(self, base: Tree, n: Node) -> Node:
        return self.graph.apply(power, self._not_negative(base), n)

    def _not_negative(self, tree: Tree) -> Node:
        """Argument of a root or a fractional power: rounding may make a vanishing one negative."""
        x = self.of(tree)
        if isinstance(tree, TextOperation) and tree.name == "abs":
            return self._with_rate(abs(self.of(tree.operands[0])), self._rate(x))
        if x.stage < Stage.POSITION:
            return x
        return self.graph.apply(kept_positive, self._held_sign(sense, x), x)

    # Functions

    def _root(self, square: Tree) -> Node:
        return self.graph.function("sqrt", self._not_negative(square))

    def _of_angle(self, name: str, angle: Tree) -> Node:
        """Sine, cosine or tangent; an angle that makes whole turns per cycle continues beyond the cycle's end."""
        graph = self.graph
        if angle == "phi":
            cosine, sine = graph.cos_q, graph.sin_q
        else:
            timed = self._follows_time(angle)
            x = self._unfolded(angle) if timed or self._turns_wholly(angle) else self.of(angle)
            cosine, sine = graph.apply(direction_of, x)
            rate = self._rate(x) if timed else graph.q
            if rate.stage == Stage.VARIANT and not any(isinstance(n, Held) for n in reached([x])):
                # Periodic if the cycle is a multiple of its period.
                graph.returns((cosine, sine), Return(TIME, rate * float(self._revolutions)))
        return {"sin": sine, "cos": cosine}.get(name) or self._quotient(sine, cosine)

    def _follows_time(self, angle: Tree) -> bool:
        """Whether a part depends on the time of a cycle at constant speed."""
        uniform = self.kinematics.scene.has_cycle and self.time is uniform_time(self.kinematics)
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
        return 0.0 if all(self._named(name).stage < Stage.POSITION for name in names) else None

    def _unfolded(self, angle: Tree) -> Node:
        """An angle that contains the crank angle and continues from one cycle to the next."""
        unfolded = _Curves(self.kinematics, self.formula, self.along, self.speed, self.time)
        unfolded._names["phi"] = self.graph.q
        found = unfolded.of(angle)
        self._rates |= unfolded._rates
        return found

    def _across(self, x: Node) -> Node:
        """Sine of the angle with a given cosine, or the reverse."""
        return self.graph.function("sqrt", (1.0 - x) * (1.0 + x))

    def _direction(self, y: Node, x: Node) -> Node:
        """Angle of a vector; it jumps where the vector points along −x."""
        if max(x.stage, y.stage) < Stage.POSITION:
            return self.graph.apply(angle_of, x, y)
        return self.graph.apply(angle_on_side, self._held_sign(side, y), x, y)

    # Switching

    def _held_sign(self, law: Callable, x: Node) -> Node:
        """Held sign or side of a quantity; a switching event is registered."""
        self._switches(self._bare.get(x, x))
        return self.graph.held(self.graph.apply(law, x))

    def _switches(self, curve: Node, level: Node | float = 0.0) -> None:
        if curve.stage == Stage.POSITION:
            self.graph.switches(curve, self._rate(curve), level)

    def _magnitude(self, x: Node) -> Node:
        return abs(x) if x.stage < Stage.POSITION else self._held_sign(sense, x) * x

    def _chosen(self, greatest: bool, found: Node, *others: Node) -> Node:
        for other in others:
            choices = (found, other) if greatest else (other, found)
            found = self._either(self._exceeds(found, other), *choices)
        return found

    def _either(self, condition: Node, *choices: Node) -> Node:
        def chosen(a: Node, b: Node) -> Node:
            return a if a is b else self.graph.apply(either, condition, a, b)

        # Also where the other choice is infinite.
        return self._with_rate(chosen(*choices), chosen(*map(self._rate, choices)))

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

    def _exceeds(self, a: Node, b: Node) -> Node:
        """1 where a exceeds b, else 0; held, with a switching event."""
        graph, zero = self.graph, self.graph.zero
        # A level that another part of the formula switches has jumps.
        if min(a.stage, b.stage) > Stage.CYCLE:
            a, b = a - b, zero
        curve, level = (a, b) if a.stage == Stage.POSITION else (b, a)
        if level is zero:
            curve = self._bare.get(curve, curve)
        if curve in self._distances:
            # The slide is known before the ends of its stroke are.
            curve, sign, end = self._distances[curve]
            level = end + sign * level
        self._switches(curve, level)
        return graph.held(graph.apply(exceeds, a, b))

    # Names

    def _named(self, name: str) -> Node:
        if name not in self._names:
            self._names[name] = self._of_name(name)
        return self._names[name]

    def _of_name(self, name: str) -> Node:
        numbers, k = self.formula.action.numbers, self.kinematics
        if name in numbers:
            return self._number(f"{self.formula.at}.numbers.{name}")
        match name:
            case "phi":
                return self._crank_angle()
            case "v":
                along = self._at_speed(self.along.velocity, self.along.slope)
                return self._product(input_sense(k), along) if self.formula.action.angle is None else along
            case "omega":
                on = self.formula.action.on
                link = k.links[on if self.along.direction is None else k.scene.input.link]
                return self._at_speed(link.w, link.e)
        if name == TIME:
            return self._with_rate(self.time, time_per_input(k))
        owner, _, quantity = name.rpartition(".")
        if owner in k.slides and quantity in OF_SLIDER:
            return self._of_slider(owner, quantity)
        if owner in k.points and quantity in OF_POINT:
            point, axis = k.points[owner], "xy".index(quantity[-1])
            if quantity[0] == "v":
                return self._at_speed(point.v[axis], point.a[axis])
            return self._with_rate(k.coordinates(point.r)[axis], point.v[axis])
        if owner in k.links and quantity == "angular_velocity":
            return self._at_speed(k.links[owner].w, k.links[owner].e)
        if owner in k.links and quantity == "angle":
            return self._link_angle(owner)
        return self._number(name)

    def _number(self, path: str) -> Node:
        # As array elements: division by 0 is then infinite.
        return self.graph.derived(f"{path} in formulas", lambda n: np.float64(1.0) * n[path])

    def _at_speed(self, transfer: Node, rate: Node) -> Node:
        """Velocity from its transfer function, with which it shares its zeros."""
        found = self._product(self.speed, self._with_rate(transfer, rate))
        self._bare[found] = self._bare.get(transfer, transfer)
        return found

    @property
    def _revolutions(self) -> int:
        return self.kinematics.scene.input.revolutions

    def _crank_angle(self) -> Node:
        """Crank angle within a cycle if the crank turns fully: it restarts at 0 after each cycle."""
        graph, drive = self.graph, self.kinematics.scene.input
        if drive.start is not None:
            return graph.q
        self._switches(graph.q)
        return graph.q - graph.held(graph.apply(cycles_before, math.tau * drive.revolutions, graph.q))

    def _link_angle(self, name: str) -> Node:
        link, drive = self.kinematics.links[name], self.kinematics.scene.input
        if name == drive.link and isinstance(drive, CrankInput):
            return self._named("phi")
        for component, rate in zip(link.u, link.w * link.u.normal, strict=True):
            self._with_rate(component, rate)
        return self._with_rate(self._direction(link.u.y, link.u.x), link.w)

    def _of_slider(self, name: str, quantity: str) -> Node:
        graph, slide = self.graph, self.kinematics.slides[name]
        low, high = (graph.found(slide.d, slide.v, which) for which in ("low", "high"))
        self._with_rate(slide.d, slide.v)
        match quantity:
            case "slide":
                return slide.d
            case "velocity":
                return self._at_speed(slide.v, slide.a)
            case "from_low":
                found, *from_end = slide.d - low, 1.0, low
            case "from_high":
                found, *from_end = high - slide.d, -1.0, high
            case _:
                return {"stroke": high - low, "stroke_low": low, "stroke_high": high}[quantity]
        self._distances[found] = slide.d, *from_end
        return found


_FACTORS = {"negative": -1.0, "radians": math.pi / 180.0, "degrees": 180.0 / math.pi}
_METHODS = {
    "+": lambda _, a, b: a + b,
    "-": lambda _, a, b: a - b,
    "*": _Curves._product,
    "/": _Curves._quotient,
    "exp": lambda curves, x: curves.graph.apply(exponential, x),
    "log": lambda curves, x: curves.graph.apply(logarithm, x),
    "asin": lambda curves, x: curves.graph.apply(angle_of, curves._across(x), x),
    "acos": lambda curves, x: curves.graph.apply(angle_of, x, curves._across(x)),
    "atan": lambda curves, x: curves.graph.apply(angle_of, 1.0, x),
    "atan2": _Curves._direction,
    "sign": lambda curves, x: curves._held_sign(sense, x),
    "abs": _Curves._magnitude,
}
