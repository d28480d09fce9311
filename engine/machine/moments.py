"""The reduced moments of a scene's actions, as terms coefficient × basis.

The coefficient is a load, one number per variant (a force, a drag coefficient times the speed, an area); the
basis depends on the shape of the motion alone: the transfer function of the loaded point or link, times the
characteristic. Characteristics that can't be vectorised (searched tables, powers, indicator diagrams) are
evaluated in a loop of their own over the positions, from rows that the vectorised loop leaves behind.

The forces and moments themselves, where they act and on what, are there too, for the reactions in the pairs.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.equal_positions.stroke_work import work_call
from engine.equal_positions.text.program import Program
from engine.laws.tables import Table, integrated, make_table
from engine.machine.mechanism import Mechanism, Moving
from engine.mechanism.actions.brakes import braking_moment
from engine.scene import actions
from engine.scene.pairs import bearer_of, holder_of
from engine.scene.parts import FRAME, CrankInput
from engine.scene.scene import Scene, scene_numbers


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
    value : str
        The characteristic alone, which the expression multiplies by a velocity.
    """

    row: str
    expression: str
    rows: tuple[str, ...]
    stroke_of: str | None = None
    clock: str = ""
    value: str = ""

    @property
    def value_row(self) -> str:
        """Row of the characteristic alone."""
        return self.row.replace("law__", "val__", 1)


class Grip(NamedTuple):
    """Where a force or moment takes hold.

    Attributes
    ----------
    link : str
    at : Moving or None
        Point of a force; None for a moment.
    direction : tuple of str
        Components of a force's direction; of a moment none.
    bearer : tuple of (str, Moving) or None
        Link and point that bear its counterpart; None where it comes from outside the machine.
    """

    link: str
    at: Moving | None
    direction: tuple[str, ...]
    bearer: tuple[str, Moving] | None = None


class Applied(NamedTuple):
    """A force or moment on a link: `coefficient` (a load slot) times `characteristic` (an expression at a position).

    `order` is that of the term it reduces to.
    """

    action: str
    coefficient: str
    characteristic: str
    grip: Grip
    order: int | str = 0


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
    works : dict of str to str
        Of laws whose work is known exactly, by their row, the call that computes it; see
        `engine.equal_positions.stroke_work`. motors : tuple of str
    along : dict of str to str
        Of each force and moment, the variable of the velocity along it, per unit of the input's.
    applied : list of Applied
        The forces and moments behind the terms, but gravity.
    """

    def __init__(self, scene: Scene, mechanism: Mechanism, program: Program, varied: frozenset[str]) -> None:
        self.scene, self.mechanism, self.program = scene, mechanism, program
        self.varied = varied
        self._paths = set(scene_numbers(scene))
        self.terms: list[Term] = []
        self.laws: dict[str, Law] = {}
        self.tables: dict[str, Table] = {}
        self.angle_tables: dict[str, Table] = {}
        self.works: dict[str, str] = {}
        self.along: dict[str, str] = {}
        self.applied: list[Applied] = []
        self._grips: dict[str, Grip] = {}
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

    def weight(self, name: str) -> str | None:
        """Slot of the weight of one of the mechanism's masses; None where there is no gravity."""
        if self.scene.gravity == 0.0 and "gravity" not in self.varied:
            return None
        part = self.mechanism.masses[name]
        return self.program.derived(f"bodies.{name}.weight", lambda n: n["gravity"] * part.mass(n), "load")

    def _gravity(self) -> None:
        p = self.program
        for name in self.mechanism.masses:
            weight, centre = self.weight(name), self.mechanism.centre(name)
            if weight is None or centre.vy == "zero":
                continue
            p.about(f"gravity on {name}", "velocity")
            self.terms.append(Term("gravity", weight, p.fresh(f"-{centre.vy}"), None))

    # Transfer functions

    def _along(self, name: str, force: actions.OnPoint) -> str:
        """Velocity of the loaded point along the force (its whole speed where no direction is given)."""
        p, point = self.program, self.mechanism.points[force.on]
        p.about(f"force {name}", "velocity")
        holder = holder_of(self.scene, force.on)
        if force.angle is None:
            p.about(f"force {name}", "force")
            direction = p.fresh_pair(f"direction_of_motion({point.vx}, {point.vy})")
            self._grips[name] = Grip(holder, point, direction)
            p.about(f"force {name}", "velocity")
            return p.fresh(f"math.sqrt({point.vx} * {point.vx} + {point.vy} * {point.vy})")
        angle = f"forces.{name}.angle"
        c = p.derived(f"{angle}.cos", lambda n: np.cos(n[angle]))
        s = p.derived(f"{angle}.sin", lambda n: np.sin(n[angle]))
        link = self.mechanism.links[force.turns_with]
        if force.turns_with != "frame":
            c, s = p.fresh_pair(f"arm({c}, {s}, {link.c}, {link.s})")
        self._grips[name] = Grip(holder, point, (c, s))
        return p.fresh(f"power_of_force({c}, {s}, {point.vx}, {point.vy})")

    def _rate(self, name: str, moment: actions.OnLink) -> str:
        self.program.about(f"moment {name}", "velocity")
        on_frame = isinstance(moment, (actions.TorsionSpring, actions.Brake))
        borne = (FRAME, self.mechanism.links[FRAME].origin) if on_frame else None
        self._grips[name] = Grip(moment.on, None, (), borne)
        return self.mechanism.links[moment.on].w

    # Actions by characteristic

    def _term(self, name: str, coefficient: str, basis: str, value: str, order: int | str = 0) -> None:
        """Add a reduced moment, and the force or moment behind it by the value of its characteristic."""
        self.applied.append(Applied(name, coefficient, value, self._grips[name], order))
        table = next(t for t in ("forces", "moments", "springs", "cylinders") if name in getattr(self.scene, t))
        role = getattr(getattr(self.scene, table)[name], "role", None)
        self.terms.append(Term(name, coefficient, basis, role, order))

    def _action(self, name: str, action: actions.OnPoint | actions.OnLink, table: str, w: str) -> None:
        p, at = self.program, f"{table}.{name}"
        self.along[name] = w
        value = "force" if table == "forces" else "moment"
        match action.type:
            case "constant":
                self._term(
                    name, p.number(f"{at}.{value}", "load"), self._masked(action, w), self._mask(action, w) or "one"
                )
            case "table":
                self._tabled(name, action, at, self._masked(action, w), self._mask(action, w))
            case "against_motion":
                coefficient = p.derived(
                    f"{at}.signed", lambda n: n[f"{at}.{value}"] * np.sign(n["input.speed"]), "load"
                )
                self._resistance(name, action, coefficient, f"constant_against_motion(one, {w})", w)
            case "linear_drag":
                coefficient = p.derived(f"{at}.at_speed", lambda n: n[f"{at}.coefficient"] * n["input.speed"], "load")
                self._resistance(name, action, coefficient, f"linear_drag(one, {w})", w, 1)
            case "quadratic_drag":
                coefficient = p.derived(
                    f"{at}.at_speed",
                    lambda n: n[f"{at}.coefficient"] * n["input.speed"] * np.abs(n["input.speed"]),
                    "load",
                )
                self._resistance(name, action, coefficient, f"quadratic_drag(one, {w})", w, 2)
            case "power_drag":
                self._power_drag(name, action, at, value, w)
            case "block_brake" | "disc_brake" | "band_brake":
                coefficient = p.derived(
                    f"{at}.signed",
                    lambda n: braking_moment(action, at, n) * np.sign(n["input.speed"]),
                    "load",
                )
                value = f"constant_against_motion(one, {w})"
                self._term(name, coefficient, p.fresh(f"{w} * {value}"), value)
            case "torsion_spring":
                link = self.mechanism.links[action.on]
                angle = f"math.atan2(row__{link.s}[k], row__{link.c}[k])"
                free = p.number(f"{at}.free_angle")
                self._law(name, w, f"spring(one, {free}, {angle})", (w, link.s, link.c))
                self._term(name, p.number(f"{at}.stiffness", "load"), f"law__{name}", f"val__{name}[k]")

    def _mask(self, action: actions.OnPoint | actions.OnLink, w: str) -> str:
        """Factor that limits an action to one direction of motion; "" where it always acts."""
        if action.acts == "always":
            return ""
        direction = "one" if action.acts == "along" else "-one"
        return f"acts_in_direction({direction}, {w} * {self._forward})"

    def _masked(self, action: actions.OnPoint | actions.OnLink, w: str) -> str:
        mask = self._mask(action, w)
        return self.program.fresh(f"{w} * {mask}") if mask else w

    def _resistance(
        self, name: str, action: actions.OnPoint, coefficient: str, value: str, w: str, order: int = 0
    ) -> None:
        basis, mask = self.program.fresh(f"{w} * {value}"), self._mask(action, w)
        if mask:
            basis, value = self.program.fresh(f"{basis} * {mask}"), f"{value} * {mask}"
        self._term(name, coefficient, basis, value, order)

    def _law(
        self, name: str, w: str, value: str, rows: tuple[str, ...], stroke_of: str | None = None, clock: str = ""
    ) -> None:
        """Add the law `w` × `value`, w a variable of the vectorised steps and the value an expression at position k."""
        rows, value = tuple(r for r in rows if r not in ("one", "zero")), value.replace("row__one[k]", "one")
        velocity = "one" if w == "one" else f"row__{w}[k]"
        self.laws[f"law__{name}"] = Law(f"law__{name}", f"{velocity} * {value}", rows, stroke_of, clock, value)

    def _power_drag(self, name: str, action: actions.PowerDragForce, at: str, value: str, w: str) -> None:
        def at_speed(n: Mapping) -> float | np.ndarray:
            speed = n["input.speed"]
            return n[f"{at}.{value}"] * np.sign(speed) * np.abs(speed / n[f"{at}.at_speed"]) ** n[f"{at}.exponent"]

        p = self.program
        row = f"row__{w}[k]"
        law, mask = f"power_law_drag(one, {p.number(f'{at}.exponent')}, {row})", self._mask(action, row)
        self._law(name, w, f"{law} * {mask}" if mask else law, (w,))
        coefficient = p.derived(f"{at}.at_input_speed", at_speed, "load")
        self._term(name, coefficient, f"law__{name}", f"val__{name}[k]", f"{at}.exponent")

    def _tabled(self, name: str, action: actions.Tabled, at: str, w: str, mask: str) -> None:
        p, drive = self.program, self.scene.input
        source = "angle_table" if action.over_angle is not None else "val"
        value = f"{source}__{name}[k]"
        self._term(name, p.number(f"{at}.scale", "load"), f"law__{name}", f"{value} * {mask}" if mask else value)
        x, y = action.abscissae, action.ordinates
        if action.over_angle is not None:
            full = isinstance(drive, CrankInput) and drive.start is None
            period = 2 * math.pi * drive.revolutions if full else 0.0
            self.angle_tables[name] = make_table(x, y, action.interpolation, period, action.outside)
            p.about(f"table {name}", "velocity")
            self.terms[-1] = self.terms[-1]._replace(basis=p.fresh(f"angle_table__{name}[k] * {w}"))
            return
        self.tables[name] = make_table(x, y, action.interpolation, outside=action.outside)
        work = work_call(self.scene, self.mechanism, p, name, self._forward)
        if work is not None:
            self.works[f"law__{name}"] = work
            self.tables[f"{name}__work"] = integrated(self.tables[name])
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
        self._law(name, w, f"table_value({fields}, {argument})", rows, stroke_of, clock)

    def _spring(self, name: str) -> None:
        p, spring, at = self.program, self.scene.springs[name], f"springs.{name}"
        a, b = (self.mechanism.points[end] for end in spring.between)
        p.about(f"spring {name}", "position")
        dx, dy = p.fresh_pair(f"{b.x} - {a.x}, {b.y} - {a.y}")
        length = p.fresh(f"math.sqrt({dx} * {dx} + {dy} * {dy})")
        p.about(f"spring {name}", "velocity")
        rate = p.fresh(f"({dx} * ({b.vx} - {a.vx}) + {dy} * ({b.vy} - {a.vy})) / {length}")
        p.about(f"spring {name}", "force")
        direction = p.fresh_pair(f"{dx} / {length}, {dy} / {length}")
        p.about(f"spring {name}", "velocity")
        holders = [holder_of(self.scene, end) for end in spring.between]
        self._grips[name] = Grip(holders[1], b, direction, (holders[0], a))
        pull = f"spring(one, {p.number(f'{at}.free_length')}, {length})"
        self._term(name, p.number(f"{at}.stiffness", "load"), p.fresh(f"{rate} * {pull}"), pull)
        if spring.damping or f"{at}.damping" in self.varied:
            coefficient = p.derived(f"{at}.damping_at_speed", lambda n: n[f"{at}.damping"] * n["input.speed"], "load")
            pull = f"linear_drag(one, {rate})"
            self._term(name, coefficient, p.fresh(f"{rate} * {pull}"), pull, 1)

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
        self._law(name, slide.dv, f"({pressure} - {number['ambient']})", (slide.d, slide.dv), cylinder.piston)
        link = self.mechanism.links[cylinder.piston]
        bearer = (bearer_of(self.scene, cylinder.piston), link.origin)
        self._grips[name] = Grip(cylinder.piston, link.origin, (link.c, link.s), bearer)
        self._term(name, area, f"law__{name}", f"val__{name}[k]")
