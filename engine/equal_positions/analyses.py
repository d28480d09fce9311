"""What is computed from the rows of a variant: the summaries, each with its error figure.

Steps and results are written with a mark `$` on every name that depends on the resolution. Each step is carried
out twice, at all positions and at every second one (`$` → `_half`); the difference of the two results is the
estimate of the discretisation error.
"""

import re
from typing import NamedTuple

from engine.machine.model import Model
from engine.machine.quantities.inertia import replacement_slots, replacement_summaries
from engine.machine.quantities.loops import RESIDUAL, loop_summaries, magnifications
from engine.machine.quantities.quantities import (
    STATISTICS,
    InputUnits,
    Quantity,
    has_cycle,
    machine_summaries,
    statistics_of,
)
from engine.machine.quantities.reactions import direction_summaries, friction_summaries, reaction_summaries
from engine.machine.quantities.shaking import ORDERS, shaking_summaries
from engine.mechanism.actions.motors import motor_moment

_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*\$?")


class RowStep(NamedTuple):
    """A statement about whole rows; `targets` are the numbers and rows it produces."""

    targets: tuple[str, ...]
    statement: str

    @property
    def needs(self) -> frozenset[str]:
        """Names that the statement uses but doesn't produce."""
        return frozenset(_NAME.findall(self.statement)) - set(self.targets)


class Result(NamedTuple):
    """Expressions of a summary and of its error figure; `may_be_undefined` where NaN is an answer."""

    value: str
    error: str
    may_be_undefined: bool = False


def row_of(model: Model, field: str) -> str:
    """Name of the row that holds a field."""
    if field in model.linear:
        return "lin__" + field.replace(".", "__")
    if field in model.angles:
        return "ang__" + field.removesuffix(".angle").replace(".", "__")
    if field in ("work", "speed", "shaking_force"):
        return f"row__{field}"
    return f"row__{model.variables[field]}"


class Analyses:
    """The summaries of a model.

    Parameters
    ----------
    model : Model

    Attributes
    ----------
    steps : list of RowStep
    results : dict of str to Result
    summaries : dict of str to Quantity
        Every summary but the statistics of fields, which `add_statistics` adds as they are asked.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.periodic = has_cycle(model.scene)
        self.steps: list[RowStep] = []
        self.results: dict[str, Result] = {}
        self.summaries = {q.name: q for q in machine_summaries(model.scene, model.structure, turning_links(model))}
        self._angles()
        self._strokes()
        self._loops()
        first_kind = model.linear["reduced_inertia"].constant
        self.results["first_kind_inertia"] = Result(first_kind, "0.0")
        self._motors()
        self._reactions()
        self._shaking()
        self.summaries |= {q.name: q for q in replacement_summaries(model.scene)}
        slots = replacement_slots(model.scene, model.mechanism, model.program)
        self.results |= {name: Result(slot, "0.0") for name, slot in slots.items()}
        if self.periodic:
            self._cycle()

    def _step(self, targets: str, call: str) -> None:
        self.steps.append(RowStep(tuple(t.strip() for t in targets.split(",")), f"{targets} = {call}"))

    def _fill(self, row: str, call: str) -> None:
        self.steps.append(RowStep((row,), call))

    def add_statistics(self, field: Quantity) -> None:
        """Make the statistics of a field available."""
        row = row_of(self.model, field.name)
        if f"{field.name}.min" in self.summaries:
            return
        low, high, below, above = self._extremes(row)
        mean, rms, rough = self._means(row)
        q = InputUnits.of(self.model.scene).q
        self.summaries.update({s.name: s for s in statistics_of(field, q)})
        lower, upper = self._extreme_doubt(low, below), self._extreme_doubt(high, above)
        peak = f"max(abs({low}$), abs({high}$))"
        size = f"rounding * {peak.replace('$', '')}"
        for suffix, value, error in (
            ("min", f"{low}$", f"{lower} + {size}"),
            ("max", f"{high}$", f"{upper} + {size}"),
            ("range", f"{high}$ - {low}$", f"{lower} + {upper} + {size}"),
            ("peak", peak, f"max({lower}, {upper})"),
        ):
            self.results[f"{field.name}.{suffix}"] = Result(value, error)
        # A jump moves the mean by up to half of it a step, two of one sign by more than the root of their squares; the
        # mean square moves by up to twice the peak times as much.
        jumps = f"0.75 * {rough} / n"
        self.results[f"{field.name}.mean"] = self._mean(row, mean, jumps, f" + rounding * {rms}")
        steeper = f"(peak_of({row}) / {rms} if {rms} > zero else one)"
        self.results[f"{field.name}.rms"] = self._mean(row, rms, f"{jumps} * {steeper}")
        for suffix, value, sign in (("min_at", low, "-one"), ("max_at", high, "one")):
            place, aside = f"{value}_at$", f"{value}_aside"
            self._step(f"{place}, {aside}$", f"place_of_extreme({row}$, {sign}, first, h$, {self.periodic}, rounding)")
            self.results[f"{field.name}.{suffix}"] = Result(place, aside)
        assert len(STATISTICS) == 8

    def _extremes(self, row: str) -> list[str]:
        """Make the extremes of a row; names of its least and its greatest value and of what they may be off by."""
        low, high, below, above = (f"{part}__{row}" for part in ("low", "high", "below", "above"))
        self._step(f"{low}$, {below}$", f"extreme_of({row}$, -one, {self.periodic})")
        self._step(f"{high}$, {above}$", f"extreme_of({row}$, one, {self.periodic})")
        return [low, high, below, above]

    def _means(self, row: str) -> list[str]:
        """Make the means of a row; names of its mean, its root-mean-square value and its jumps."""
        mean, rms, rough = (f"{part}__{row}" for part in ("mean", "rms", "rough"))
        self._step(f"{mean}$, {rms}$", f"means({row}$, 1, {self.periodic})")
        self._step(f"{mean}_of_few$, {rms}_of_few$", f"means({row}$, 2, {self.periodic})")
        self._step(f"{rough}$", f"roughness({row}$, {self.periodic})")
        return [mean, rms, rough]

    def _extreme_doubt(self, value: str, off: str) -> str:
        """What an extreme may be off by."""
        return f"doubt_of_extreme({value}, {value}_half, {off}, {off}_half)"

    def _mean(self, row: str, mean: str, jumps: str, more: str = "") -> Result:
        """Result of a row's mean or root-mean-square value."""
        rough, quarter = f"rough__{row}", f"{mean}_of_few_half"
        return Result(
            f"{mean}$", f"doubt_of_mean({mean}, {mean}_half, {quarter}, {rough}, {rough}_half, {jumps}){more}"
        )

    def _angles(self) -> None:
        for field, (c, s) in self.model.angles.items():
            row = row_of(self.model, field)
            self._fill(f"{row}$", f"unwrap_angle(row__{c}$, row__{s}$, {row}$)")

    def _strokes(self) -> None:
        m = self.model.mechanism
        for name, slide in m.slides.items():
            ends = f"low__{name}$, high__{name}$, low_at__{name}$, high_at__{name}$"
            self._step(ends, f"stroke_ends(row__{slide.d}$, row__{slide.dv}$, first, h$, {self.periodic})")
            self._ends(name, "stroke", name, slide.dv, False)
        for name in turning_links(self.model):
            ends = ", ".join(f"{end}__turn_{name}$" for end in ("low", "high", "low_at", "high_at"))
            link = m.links[name]
            rows = f"row__{link.c}$, row__{link.s}$, row__{link.w}$"
            self._step(ends, f"swing_ends({rows}, first, h$, {self.periodic})")
            self._ends(name, "swing", f"turn_{name}", link.w, True)

    def _loops(self) -> None:
        """How the groups transmit forces and magnify errors, and whether their loops close."""
        self.summaries |= {q.name: q for q in loop_summaries(self.model.scene)}
        for group, sine in self.model.mechanism.sines.items():
            low, high, below, above = self._extremes(f"row__{sine}")
            least, missed = f"least__{sine}", f"missed__{sine}"
            self._step(f"{least}$", f"least_magnitude({low}$, {high}$)")
            self._step(f"{missed}$", f"{above}$ if {high}$ < zero else {below}$")
            off = f"off__{sine}"
            self._step(off, f"rounding + {self._extreme_doubt(least, missed)}")
            angle, lower = f"transmission_angle({least}$)", f"transmission_angle(max({least} - {off}, zero))"
            self.results[f"{group}.transmission_angle"] = Result(angle, f"{angle.replace('$', '')} - {lower}")
        for name, (value, missed) in magnifications(self.model.mechanism.sines).items():
            self.results[name] = Result(value, missed)
        worst = ""
        for variable in self.model.closures.values():
            peak = f"peak_of(row__{variable})"
            worst = f"greater({worst}, {peak})" if worst else peak
        if worst:
            self._step(RESIDUAL, worst)
            self.results[RESIDUAL] = Result(RESIDUAL, "0.0")

    def _ends(self, name: str, kind: str, variable: str, rate: str, may_be_undefined: bool) -> None:
        def add(what: str, value: str, error: str) -> None:
            self.results[f"{name}.{what}"] = Result(value, error, may_be_undefined)

        size = f"rounding * (abs(high__{variable}) + abs(low__{variable}))"
        ends, places = [], []
        for end in ("low", "high"):
            at, off, aside = (f"{end}{part}__{variable}" for part in ("_at", "_off", "_aside"))
            doubt = f"cubic_doubt(row__{rate}, first, h, {at}, {size}, {self.periodic})"
            self._step(f"{off}, {aside}", doubt)
            ends.append(difference(f"{end}__{variable}$", f"{off} + {size}").error)
            places.append(difference(f"{at}$", aside).error)
        add(kind, f"high__{variable}$ - low__{variable}$", " + ".join(ends))
        add(f"{kind}_low", f"low__{variable}$", ends[0])
        add(f"{kind}_high", f"high__{variable}$", ends[1])
        add(f"{kind}_low_at", f"low_at__{variable}$", places[0])
        add(f"{kind}_high_at", f"high_at__{variable}$", places[1])
        if self.periodic:
            ratio = f"quick_return_ratio(low_at__{variable}$, high_at__{variable}$)"
            # R = α/(2π − α): dR = (1 + R)²/(2π) dα.
            grows = f"(1.0 + {ratio.replace('$', '')}) ** 2 / (2.0 * math.pi)"
            add(f"{kind}_time_ratio", ratio, f"{grows} * ({' + '.join(places)})")

    def _motors(self) -> None:
        moments = self.model.moments
        if moments.motors:
            slot = self.model.program.derived(
                "motor_moment", lambda n: motor_moment(self.model.scene, moments.motors, n), "load"
            )
            self.results["motor_moment"] = Result(slot, "0.0")

    def _shaking(self) -> None:
        """Magnitude of the shaking force, and its orders."""
        x, y = "lin__shaking_force_x", "lin__shaking_force_y"
        self._fill("row__shaking_force", f"magnitudes({x}, {y}, row__shaking_force)")
        self.summaries |= {q.name: q for q in shaking_summaries(self.model.scene)}
        for n in ORDERS if self.periodic else ():
            self._step(f"order_{n}$, terms_{n}$", f"order_of({x}$, {y}$, {n}, cos_nodes, sin_nodes)")
            # Fewer positions can't tell an order from its mirror image, at half of them.
            few = f"n <= {4 * n * self.model.scene.input.revolutions}"
            doubt = f"(4.0 if {few} else rounding) * terms_{n}"
            self.results[f"shaking_force.order_{n}"] = difference(f"order_{n}$", doubt)

    def _reactions(self) -> None:
        self.summaries |= {q.name: q for q in reaction_summaries()}
        rows = {key: f"row__{variable}" for key, variable in self.model.reactions.checks.items()}
        residual = f"unbalanced_share({rows['force']}, {rows['forces']}, {rows['moment']}, {rows['moments']})"
        self._step("equilibrium_residual", residual)
        self.results["equilibrium_residual"] = Result("equilibrium_residual", "0.0")
        ways = [row_of(self.model, f"input_moment{way}") for way in ("", "_by_equilibrium", "_by_power")]
        if self.model.scene.friction:
            friction = row_of(self.model, "friction_moment")
            self._fill("row__against_friction", f"less_friction({ways[0]}, {friction}, row__against_friction)")
            ways[0] = "row__against_friction"
        self._step("input_moment_disagreement", f"greatest_disagreement({', '.join(ways)})")
        self.results["input_moment_disagreement"] = Result("input_moment_disagreement", "0.0")
        if self.model.scene.friction:
            self._friction()
        self.summaries |= {q.name: q for q in direction_summaries(self.model.scene)}
        for (pair, link), force in self.model.reactions.in_axes.items():
            self._load_directions(pair, link, force)

    def _load_directions(self, pair: str, link: str, force: tuple[str, str]) -> None:
        """Mean direction and spread of the load on a link in a bearing, and the widest arc without any."""
        whole = self.model.variables[f"{pair}.reaction"]
        for variable in (*force, whole):
            self._means(f"row__{variable}")
        (x, y, mean), (jx, jy, j) = ([f"{p}__row__{v}" for v in (*force, whole)] for p in ("mean", "rough"))
        off = f"math.hypot({x} - {x}_half, {y} - {y}_half) + 0.5 * math.hypot({jx}, {jy}) / n + rounding * {mean}"
        direction, spread = f"math.atan2({y}$, {x}$)", f"1.0 - math.hypot({x}$, {y}$) / {mean}$"
        self.results[f"{pair}.load_direction_of_{link}"] = Result(direction, f"direction_doubt({off}, {x}, {y})", True)
        # What is divided by the mean is no greater than it.
        change = f"({off} + abs({mean} - {mean}_half) + 0.5 * {j} / n) / {mean}"
        self.results[f"{pair}.load_spread_of_{link}"] = Result(spread, change, True)
        key = f"{pair.replace('.', '__')}__{link}"
        arc, middle, doubt, low, high = (f"{w}__{key}$" for w in ("arc", "amid", "adoubt", "row__alow", "row__ahigh"))
        rows = ", ".join((*(f"row__{v}$" for v in force), low, high))
        made = (arc, middle, doubt)
        self.steps.append(RowStep((*made, low, high), f"{', '.join(made)} = unloaded_arc({rows}, {self.periodic})"))
        self.results[f"{pair}.unloaded_arc_of_{link}"] = difference(arc, doubt.replace("$", ""))
        change = f"middle_doubt({middle}, {middle.replace('$', '_half')}, {arc}, {doubt})".replace("$", "")
        self.results[f"{pair}.unloaded_middle_of_{link}"] = Result(middle, change, True)

    def _friction(self) -> None:
        """What friction in the pairs costs, how its passes went, and where it jams."""
        self.summaries |= {q.name: q for q in friction_summaries(self.model.scene)}
        for settling in self.model.reactions.settlings.values():
            self._step(f"free__{settling.group}", f"least({settling.margin})")
            self._step(f"jams__{settling.group}", f"first_jammed({settling.margin}, jammed)")
            self.results[f"jams__{settling.group}"] = Result(f"jams__{settling.group}", "0.0", may_be_undefined=True)
        settlings = self.model.reactions.settlings.values()
        for name, choose, numbers, other in (
            ("friction_passes", "max", [s.passes for s in settlings], "zero"),
            ("friction_residual", "max", [s.residual for s in settlings], "zero"),
            ("jamming_margin", "min", [f"free__{s.group}" for s in settlings], "one"),
        ):
            self.results[name] = Result(f"{choose}({', '.join([*numbers, other])})", "0.0")
        of_all = self.model.variables["friction_moment"]
        lost = {f"{pair}.friction_work": v for pair, v in self.model.reactions.lost.items()} | {"friction_loss": of_all}
        for name, variable in lost.items():
            self._step(f"lost__{variable}$, doubt__{variable}$", f"work_over(row__{variable}$, h$, {self.periodic})")
            self.results[name] = difference(f"lost__{variable}$", f"doubt__{variable}$")
        if self.periodic:
            self._step("driving$", "mean_of(lin__driving_moment$)")
            self._step("rubbing$", f"mean_of(row__{of_all}$)")
            efficiency = "mechanical_efficiency(useful$, driving$, mean_moment$, rubbing$)"
            self.results["mechanical_efficiency"] = difference(efficiency, may_be_undefined=True)

    # The steady cycle and its flywheel

    def _cycle(self) -> None:
        omega = self.model.program.number("input.speed", "load")
        inertia = "lin__reduced_inertia$"
        self._work()
        self._step("residual$", f"derivative_residual({inertia}, lin__reduced_inertia_phi$, h$)")
        self._step("mean_inertia", "mean_of(lin__reduced_inertia)")
        self._step("missed", f"missed_extreme(lin__reduced_inertia, row__work, 0.5 * {omega} * {omega})")
        jump = "mean_doubt / (h * n)"
        self.results["required_drive_moment"] = difference("-mean_moment$", jump)
        self.results["required_power"] = difference(f"-mean_moment$ * {omega}", f"abs({omega}) * {jump}")
        self.results["mean_useful_moment"] = difference("-useful$", jump)
        self.results["power_balance_residual"] = Result("residual$", "0.0")
        self._flywheel(inertia, omega)

    def _work(self) -> None:
        """Mean moments, work over the cycle and its doubt: exactly where that is known, else by the trapezoid rule."""
        works, rows = self.model.moments.works, ("reduced_moment", "useful_moment")
        known = {name: [t for t in self.model.linear[name].terms if t[1] in works] for name in rows}
        for _, law in known["reduced_moment"]:
            name = law.removeprefix("law__")
            self.steps.append(RowStep((f"total__{name}$", f"pot__{name}$"), f"total__{name}$ = {works[law]}"))
        for target, name in (("mean_moment$", "reduced_moment"), ("useful$", "useful_moment")):
            totals = [f"{c} * {law.replace('law__', 'total__')}$" for c, law in known[name]]
            mean = f"mean_of(lin__{'other_' if totals else ''}{name}$)"
            self._step(target, f"{mean} + ({' + '.join(totals)}) / (h * n)" if totals else mean)
        exact = [f"{c} * {b.replace('law__', 'pot__')}$[k]" for c, b in known[rows[0]]]
        # An extreme of the work hides between positions where the moment jumps, however well the work is known there.
        self._step("doubt", "work_doubt(lin__reduced_moment, h)")
        if not exact:
            self._fill("row__work$", "cumulative_work(lin__reduced_moment$, mean_moment$, h$, row__work$)")
            self._step("mean_doubt", "work_doubt(lin__reduced_moment, h)")
        else:
            other = "lin__other_reduced_moment"
            self._step("mean_doubt", f"work_doubt({other}, h)")
            self._fill("row__other_work$", f"cumulative_work({other}$, mean_moment$, h$, row__other_work$)")
            total = " + ".join(("row__other_work$[k]", *exact))
            self._fill("row__work$", f"for k in range(row__work$.shape[0]): row__work$[k] = {total}")

    def _flywheel(self, inertia: str, omega: str) -> None:
        p, flywheel = self.model.program, self.model.scene.flywheel
        asked = flywheel is not None and flywheel.speed_fluctuation is not None
        delta = p.number("flywheel.speed_fluctuation", "load") if asked else "one"
        first_kind = self.model.linear["reduced_inertia"].constant
        self._step(
            "excess$, by_excess$, merzalov$, wittenbauer$",
            f"flywheel_sizes({inertia}, row__work$, {omega}, {delta}, {first_kind})",
        )
        self.results["excess_work"] = difference("excess$", "doubt")
        if flywheel is None:
            return
        if asked:
            jump = f"({self._energy_doubt(omega)}) / ({delta} * {omega} * {omega})"
            self.results["flywheel_excess_work"] = difference("by_excess$", jump)
            self.results["flywheel_merzalov"] = difference("merzalov$", jump)
            self.results["flywheel_wittenbauer"] = difference("wittenbauer$", jump)
            for name, variable in (("excess_work", "by_excess"), ("merzalov", "merzalov")):
                relative = f"(1.0 + abs({variable} / wittenbauer)) * {jump} / abs(wittenbauer)"
                self.results[f"{name}_difference"] = difference(f"{variable}$ / wittenbauer$ - 1.0", relative)
        given = flywheel.inertia is not None
        if given or asked:
            wheel = p.number("flywheel.inertia", "load") if given else "max(wittenbauer$, 0.0)"
            self._speeds(inertia, omega, wheel)

    @staticmethod
    def _energy_doubt(omega: str) -> str:
        """What energies may be off by: hidden jumps, extremes between positions, rounding of the whole energy."""
        return f"doubt + 2.0 * missed + rounding * (excess + {omega} * {omega} * mean_inertia)"

    def _speeds(self, inertia: str, omega: str, wheel: str) -> None:
        self._step("wheel$", wheel)
        self._step("energy$, delta$", f"fluctuation_with_flywheel({inertia}, row__work$, wheel$, abs({omega}))")
        self._fill("row__speed$", f"speed_row({inertia}, row__work$, wheel$, energy$, row__speed$)")
        jump = f"({self._energy_doubt(omega)}) / (2.0 * energy / {omega} / {omega})"
        share = f"{jump} / abs({omega})"

        self.results["speed_fluctuation"] = difference("delta$", f"2.0 * {share} / abs({omega})")
        given = wheel.startswith("num_")
        doubt = "" if given else self.results["flywheel_wittenbauer"].error.split(" + ", 1)[1]
        self.results["flywheel_used"] = difference("wheel$", doubt)
        self.results["speed_min"] = difference(f"abs({omega}) * (1.0 - 0.5 * delta$)", share)
        self.results["speed_max"] = difference(f"abs({omega}) * (1.0 + 0.5 * delta$)", share)


def turning_links(model: Model) -> tuple[str, ...]:
    """Links that turn but aren't known to turn uniformly: those that may swing."""
    links = model.mechanism.links
    return tuple(name for name in model.structure.links if links[name].w is not None and links[name].e is not None)


def difference(value: str, more: str = "", may_be_undefined: bool = False) -> Result:
    """Result whose error is its change from half the positions, plus `more`."""
    change = f"abs(({value}) - ({value.replace('$', '_half')}))"
    return Result(value, f"{change} + {more}" if more else change, may_be_undefined)
