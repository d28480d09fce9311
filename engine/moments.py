"""The reduced moments of a scene's actions, as terms coefficient × basis.

The coefficient is a load, one number per variant (a force, a drag coefficient times the speed, an area); the
basis depends on the shape of the motion alone: the transfer function of the loaded point or link, times the
characteristic. Characteristics that can't be vectorised (searched tables, powers, indicator diagrams) are
evaluated in a loop of their own over the positions, from rows that the vectorised loop leaves behind.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine import actions
from engine.braking import braking_moment
from engine.inertia import body_mass
from engine.mechanism import Mechanism
from engine.parts import CrankInput
from engine.program import Program
from engine.scene import Scene, scene_numbers
from engine.tables import Table, make_table


class Term(NamedTuple):
    """A reduced moment: `coefficient` (a load slot) times `basis` (a variable, or the row of a law).

    `order` is the power of the input's speed with which it grows; for a power-law drag the path of its exponent.
    """

    action: str
    coefficient: str
    basis: str
    role: str | None
    order: int | str = 0


class Law(NamedTuple):
    """A row evaluated position by position in a loop of its own.

    Attributes
    ----------
    row : str
        The row it fills.
    expression : str
        Its value at position k, from rows and per-variant numbers.
    rows : tuple of str
        Variables of the vectorised steps that it reads as rows.
    stroke_of : str or None
        Slider whose ends of stroke it needs.
    clock : str
        What in the expression is the time since the first position; "" where time plays no part.
    """

    row: str
    expression: str
    rows: tuple[str, ...]
    stroke_of: str | None = None
    clock: str = ""


class Moments:
    """Writes the actions of a scene into a program.

    Attributes
    ----------
    terms : list of Term
        Of all actions but motors, gravity first.
    laws : dict of str to Law
        By the row they fill.
    tables : dict of str to Table
        Searched tables, by the name of their action.
    angle_tables : dict of str to Table
        Tables over the crank angle, evaluated once at the nodes for all variants.
    motors : tuple of str
    along : dict of str to str
        Of each force and moment, the variable of the velocity along it, per unit of the input's.
    """

    def __init__(self, scene: Scene, mechanism: Mechanism, program: Program, varied: frozenset[str]) -> None:
        self.scene, self.mechanism, self.program = scene, mechanism, program
        self.varied = varied
        self._paths = set(scene_numbers(scene))
        self.terms: list[Term] = []
        self.laws: dict[str, Law] = {}
        self.tables: dict[str, Table] = {}
        self.angle_tables: dict[str, Table] = {}
        self.along: dict[str, str] = {}
        motors = (actions.DCMotor, actions.InductionMotor)
        self.motors = tuple(n for n, m in scene.moments.items() if isinstance(m, motors))
        # The sign of the speed decides which way the cycle is run through; it is the motion's shape.
        self._forward = program.derived("input.forward", lambda n: np.sign(n["input.speed"]) + 0.0)
        self._gravity()
        for name, action in scene.forces.items():
            self._action(name, action, "forces", self._along(name, action))
        for name, action in scene.moments.items():
            if name not in self.motors:
                self._action(name, action, "moments", self._rate(name, action))
        for name in scene.springs:
            self._spring(name)
        for name in scene.cylinders:
            self._cylinder(name)

    def _gravity(self) -> None:
        scene, p = self.scene, self.program
        if scene.gravity == 0.0 and "gravity" not in self.varied:
            return
        for name in scene.bodies:

            def weight(n: Mapping, name: str = name) -> float | np.ndarray:
                return n["gravity"] * body_mass(scene, name, n)

            centre = self.mechanism.centre(name)
            if centre.vy == "zero":
                continue
            p.about(f"gravity on {name}", "velocity")
            basis = p.fresh(f"-{centre.vy}")
            self.terms.append(Term("gravity", p.derived(f"bodies.{name}.weight", weight, "load"), basis, None))

    # Transfer functions

    def _along(self, name: str, force: actions.OnPoint) -> str:
        """Velocity of the loaded point along the force (its whole speed where no direction is given)."""
        p, point = self.program, self.mechanism.points[force.on]
        p.about(f"force {name}", "velocity")
        if force.angle is None:
            return p.fresh(f"math.sqrt({point.vx} * {point.vx} + {point.vy} * {point.vy})")
        angle = f"forces.{name}.angle"
        c = p.derived(f"{angle}.cos", lambda n: np.cos(n[angle]))
        s = p.derived(f"{angle}.sin", lambda n: np.sin(n[angle]))
        link = self.mechanism.links[force.turns_with]
        if force.turns_with != "frame":
            c, s = p.fresh_pair(f"arm({c}, {s}, {link.c}, {link.s})")
        return p.fresh(f"power_of_force({c}, {s}, {point.vx}, {point.vy})")

    def _rate(self, name: str, moment: actions.OnLink) -> str:
        self.program.about(f"moment {name}", "velocity")
        return self.mechanism.links[moment.on].w

    # Actions by characteristic

    def _term(self, name: str, coefficient: str, basis: str, order: int | str = 0) -> None:
        table = next(t for t in ("forces", "moments", "springs", "cylinders") if name in getattr(self.scene, t))
        role = getattr(getattr(self.scene, table)[name], "role", None)
        self.terms.append(Term(name, coefficient, basis, role, order))

    def _action(self, name: str, action: actions.OnPoint | actions.OnLink, table: str, w: str) -> None:
        p, at = self.program, f"{table}.{name}"
        self.along[name] = w
        value = "force" if table == "forces" else "moment"
        match action.type:
            case "constant":
                self._term(name, p.number(f"{at}.{value}", "load"), self._masked(action, w))
            case "table":
                self._tabled(name, action, at, self._masked(action, w))
            case "against_motion":
                coefficient = p.derived(
                    f"{at}.signed", lambda n: n[f"{at}.{value}"] * np.sign(n["input.speed"]), "load"
                )
                self._resistance(name, action, coefficient, f"{w} * constant_against_motion(one, {w})", w)
            case "linear_drag":
                coefficient = p.derived(f"{at}.at_speed", lambda n: n[f"{at}.coefficient"] * n["input.speed"], "load")
                self._resistance(name, action, coefficient, f"{w} * linear_drag(one, {w})", w, 1)
            case "quadratic_drag":
                coefficient = p.derived(
                    f"{at}.at_speed",
                    lambda n: n[f"{at}.coefficient"] * n["input.speed"] * np.abs(n["input.speed"]),
                    "load",
                )
                self._resistance(name, action, coefficient, f"{w} * quadratic_drag(one, {w})", w, 2)
            case "power_drag":
                self._power_drag(name, action, at, value, w)
            case "block_brake" | "disc_brake" | "band_brake":
                coefficient = p.derived(
                    f"{at}.signed",
                    lambda n: braking_moment(action, at, n) * np.sign(n["input.speed"]),
                    "load",
                )
                self._term(name, coefficient, p.fresh(f"{w} * constant_against_motion(one, {w})"))
            case "torsion_spring":
                link = self.mechanism.links[action.on]
                angle = f"math.atan2(row__{link.s}[k], row__{link.c}[k])"
                free = p.number(f"{at}.free_angle")
                expression = f"row__{w}[k] * spring(one, {free}, {angle})"
                self._law(name, expression, (w, link.s, link.c))
                self._term(name, p.number(f"{at}.stiffness", "load"), f"law__{name}")

    def _masked(self, action: actions.OnPoint | actions.OnLink, w: str) -> str:
        if action.acts == "always":
            return w
        direction = "one" if action.acts == "along" else "-one"
        return self.program.fresh(f"{w} * acts_in_direction({direction}, {w} * {self._forward})")

    def _resistance(
        self, name: str, action: actions.OnPoint, coefficient: str, basis: str, w: str, order: int = 0
    ) -> None:
        basis = self.program.fresh(basis)
        if action.acts != "always":
            direction = "one" if action.acts == "along" else "-one"
            basis = self.program.fresh(f"{basis} * acts_in_direction({direction}, {w} * {self._forward})")
        self._term(name, coefficient, basis, order)

    def _law(
        self, name: str, expression: str, rows: tuple[str, ...], stroke_of: str | None = None, clock: str = ""
    ) -> None:
        rows = tuple(r for r in rows if r not in ("one", "zero"))
        self.laws[f"law__{name}"] = Law(
            f"law__{name}", expression.replace("row__one[k]", "one"), rows, stroke_of, clock
        )

    def _power_drag(self, name: str, action: actions.PowerDragForce, at: str, value: str, w: str) -> None:
        def at_speed(n: Mapping) -> float | np.ndarray:
            speed = n["input.speed"]
            return n[f"{at}.{value}"] * np.sign(speed) * np.abs(speed / n[f"{at}.at_speed"]) ** n[f"{at}.exponent"]

        p = self.program
        row = f"row__{w}[k]"
        expression = f"{row} * power_law_drag(one, {p.number(f'{at}.exponent')}, {row})"
        if action.acts != "always":
            direction = "one" if action.acts == "along" else "-one"
            expression += f" * acts_in_direction({direction}, {row} * {self._forward})"
        self._law(name, expression, (w,))
        self._term(name, p.derived(f"{at}.at_input_speed", at_speed, "load"), f"law__{name}", f"{at}.exponent")

    def _tabled(self, name: str, action: actions.Tabled, at: str, w: str) -> None:
        p, drive = self.program, self.scene.input
        self._term(name, p.number(f"{at}.scale", "load"), f"law__{name}")
        x, y = action.abscissae, action.ordinates
        if action.over_angle is not None:
            full = isinstance(drive, CrankInput) and drive.start is None
            period = 2 * math.pi * drive.revolutions if full else 0.0
            self.angle_tables[name] = make_table(x, y, action.interpolation, period, action.outside)
            p.about(f"table {name}", "velocity")
            self.terms[-1] = self.terms[-1]._replace(basis=p.fresh(f"angle_table__{name}[k] * {w}"))
            return
        self.tables[name] = make_table(x, y, action.interpolation, outside=action.outside)
        rows, stroke_of, clock = (w,), None, ""
        if action.over_time is not None:
            place = "nodes[k]"
            if not isinstance(drive, CrankInput):
                place = f"({p.number('input.stop')} - {p.number('input.start')}) * nodes[k]"
            argument = clock = f"{place} / {p.number('input.speed')}"
        else:
            slide = self.mechanism.slides[action.slider]
            rows, place = (w, slide.d), f"row__{slide.d}[k]"
            if action.measured_from != "guide":
                stroke_of = action.slider
            argument = {
                "guide": place,
                "low end": f"{place} - low__{action.slider}",
                "high end": f"high__{action.slider} - {place}",
            }[action.measured_from]
        fields = ", ".join(f"table__{name}_{field}" for field in Table._fields)
        self._law(name, f"row__{w}[k] * table_value({fields}, {argument})", rows, stroke_of, clock)

    def _spring(self, name: str) -> None:
        p, spring, at = self.program, self.scene.springs[name], f"springs.{name}"
        a, b = (self.mechanism.points[end] for end in spring.between)
        p.about(f"spring {name}", "position")
        dx, dy = p.fresh_pair(f"{b.x} - {a.x}, {b.y} - {a.y}")
        length = p.fresh(f"math.sqrt({dx} * {dx} + {dy} * {dy})")
        p.about(f"spring {name}", "velocity")
        rate = p.fresh(f"({dx} * ({b.vx} - {a.vx}) + {dy} * ({b.vy} - {a.vy})) / {length}")
        free = p.number(f"{at}.free_length")
        self._term(name, p.number(f"{at}.stiffness", "load"), p.fresh(f"{rate} * spring(one, {free}, {length})"))
        if spring.damping or f"{at}.damping" in self.varied:
            coefficient = p.derived(f"{at}.damping_at_speed", lambda n: n[f"{at}.damping"] * n["input.speed"], "load")
            self._term(name, coefficient, p.fresh(f"{rate} * linear_drag(one, {rate})"), 1)

    # Cylinders

    def _cylinder(self, name: str) -> None:
        p, cylinder, at = self.program, self.scene.cylinders[name], f"cylinders.{name}"
        slide = self.mechanism.slides[cylinder.piston]
        sign = -1.0 if cylinder.head == "high" else 1.0
        area = p.derived(f"{at}.area", lambda n: sign * math.pi / 4 * n[f"{at}.bore"] ** 2, "load")
        number = {key: p.number(f"{at}.{key}") for key in type(cylinder).model_fields if f"{at}.{key}" in self._paths}
        d, v = f"row__{slide.d}[k]", f"row__{slide.dv}[k]"
        low, high = f"low__{cylinder.piston}", f"high__{cylinder.piston}"
        travel = f"{high} - {d}" if cylinder.head == "high" else f"{d} - {low}"
        toward = f"{v} * {self._forward} > zero" if cylinder.head == "high" else f"{v} * {self._forward} < zero"
        stroke = f"{high} - {low}"
        gas = f"{travel}, {stroke}, {number.get('clearance')}"
        exponents = f"{number.get('n_compression')}, {number.get('n_expansion')}"
        pressures = f"{number.get('intake')}, {number.get('exhaust')}, {number.get('peak')}, {exponents}"
        firing = number.get("firing_angle", "zero")
        head_at = f"{cylinder.head}_at__{cylinder.piston}"
        turn = f"{head_at}, {firing}, {self._forward}, nodes[k], {toward}"
        lines = f"{number.get('suction')}, {number.get('discharge')}"
        pressure = {
            "compressor": f"polytropic_compressor({gas}, {toward}, {lines}, {exponents})",
            "pump": f"pump({toward}, {lines})",
            "four_stroke": f"four_stroke_engine({gas}, four_stroke_number({turn}), {pressures})",
            "two_stroke": f"two_stroke_engine({gas}, two_stroke_number({toward}), {pressures}, {number.get('port')})",
        }[cylinder.type]
        self._law(name, f"{v} * ({pressure} - {number['ambient']})", (slide.d, slide.dv), cylinder.piston)
        self._term(name, area, f"law__{name}")
