"""Speed against accuracy on random machines, and how true the error figures are.

    python results/accuracy/trade.py

writes trade.md, trade.png, calibration.md and calibration.png beside this file; about 23 minutes on two cores, half of
it compiling.
"""

import argparse
import platform
from pathlib import Path

import calibration
import knobs
import masses
import numpy as np
import passes
import steps
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from measured import ACCURACIES, POSITIONS, SETTINGS, Found, Setting, costs, measured
from quantities import LOADS, TARGETS, class_of, loads_of
from random_machines import kinds

HERE = Path(__file__).parent
SHOWN = (48, 180, 720, 2880)
ASKED = tuple(Setting(720, accuracy=a, few=True) for a in ACCURACIES)
DRAWN = (
    *("velocities, accelerations: extremes", "velocities, accelerations: mean, rms", "strokes, swings"),
    *("reactions: extremes", "reactions: mean, rms", "required moment and power"),
    *("excess work", "flywheels", "speed fluctuation"),
)

Groups = dict[tuple[str, str], dict[Setting, np.ndarray]]


def grouped(found: Found) -> Groups:
    """True errors, relative, by group of summaries and of loads."""
    groups: dict[tuple[str, str], dict[Setting, list]] = {}
    for kind, by_setting in found.items():
        for setting, summaries in by_setting.items():
            sized = "flywheel_wittenbauer" in summaries
            for name, e in summaries.items():
                if sized and name.startswith("speed_"):
                    continue
                known = np.isfinite(e.errors) & (e.scales > 0)
                errors = np.maximum(e.errors - e.doubts, 0)[known] / e.scales[known]
                groups.setdefault((class_of(name), loads_of(kind)), {}).setdefault(setting, []).append(errors)
    return {key: {s: np.concatenate(parts) for s, parts in by.items()} for key, by in sorted(groups.items())}


def _worst_but_one_percent(errors: np.ndarray) -> float:
    return float(np.quantile(errors, 0.99))


def choices(groups: Groups, cost: dict[Setting, float]) -> list[str]:
    """Lines of the table to choose from: the cheapest setting that keeps 99 % of machines within a target."""
    lines = ["| summaries | loads | " + " | ".join(TARGETS) + " |", "|---" * (len(TARGETS) + 2) + "|"]
    for (name, loads), by_setting in groups.items():
        cells = []
        for target in TARGETS.values():
            enough = [s for s in by_setting if _worst_but_one_percent(by_setting[s]) <= target]
            best = min(enough, key=cost.get, default=None)
            cells.append("–" if best is None else f"{best.label} ({cost[best]:.2g})")
        lines.append(f"| {name} | {loads} | " + " | ".join(cells) + " |")
    return lines


def errors_table(groups: Groups) -> list[str]:
    """Lines of the table of true errors."""
    settings = [*(Setting(n) for n in SHOWN), Setting(720, "float32"), *ASKED[::2]]
    lines = [
        "| summaries | loads | " + " | ".join(s.label for s in settings) + " |",
        "|---" * (len(settings) + 2) + "|",
    ]
    for (name, loads), by in groups.items():
        cells = [
            " ".join(f"{v:.0e}" for v in (np.median(by[s]), _worst_but_one_percent(by[s]), by[s].max()))
            if s in by
            else "–"
            for s in settings
        ]
        lines.append(f"| {name} | {loads} | " + " | ".join(cells) + " |")
    return lines


def cost_table(cost: dict[Setting, float]) -> list[str]:
    """Lines of the table of costs."""
    lines = ["| | " + " | ".join(str(n) for n in POSITIONS) + " |", "|---" * (len(POSITIONS) + 1) + "|"]
    for precision in ("float64", "float32"):
        cells = (f"{cost[Setting(n, precision)]:.2g}" for n in POSITIONS)
        lines.append(f"| {precision} | " + " | ".join(cells) + " |")
    lines += [f"| {setting.label} | {cost[setting]:.2g}" + " | " * len(POSITIONS) for setting in ASKED]
    return lines


def draw(groups: Groups, cost: dict[Setting, float]) -> Figure:
    """Errors over cost."""
    figure = Figure(figsize=(13, 10), layout="constrained")
    axes = figure.subplots(3, 3, sharex=True, sharey=True)
    colours = dict(zip(LOADS, ("tab:blue", "tab:green", "tab:red"), strict=True))
    for ax, name in zip(axes.flat, DRAWN, strict=True):
        for loads, colour in colours.items():
            by = groups.get((name, loads))
            if by is None:
                continue
            for precision, line in (("float64", "-o"), ("float32", ":")):
                settings = [Setting(n, precision) for n in POSITIONS]
                error = [max(_worst_but_one_percent(by[s]), 1e-17) for s in settings]
                label = f"{loads}, {precision}"
                ax.plot([cost[s] for s in settings], error, line, color=colour, ms=3, lw=1, label=label)
            asked = [s for s in ASKED if s in by]
            if not asked:
                continue
            error = [max(_worst_but_one_percent(by[s]), 1e-17) for s in asked]
            ax.plot([cost[s] for s in asked], error, "*", color=colour, ms=8, label=f"{loads}, accuracy asked")
        ax.set(xscale="log", yscale="log", title=name, ylim=(1e-17, 3))
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.grid(alpha=0.3)
    for ax in axes[-1]:
        ax.set_xlabel("time per variant / that of 720 positions, float64")
    for ax in axes[:, 0]:
        ax.set_ylabel("relative error, 99 % of machines")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), fontsize=9, ncols=6, loc="outside lower center")
    return figure


def described() -> list[str]:
    """Lines of the table of machines."""
    lines = ["| machine | groups | loads |", "|---|---|---|"]
    for kind in kinds():
        order = ", ".join(group.type for group in kind.scene.groups.values())
        lines.append(f"| {kind.name} | {order} | {kind.loads} |")
    return lines


def of_models(count: int) -> dict[str, object]:
    """Measure friction's passes, replacement masses and the steps of motion; parts of the text."""
    rubbed, rods, driven = passes.measured(count), masses.measured(2 * count), steps.measured(count)
    return {
        "rubbed": rubbed.margins.size,
        "passes": "\n".join(passes.choices(rubbed)),
        "passes_errors": "\n".join(passes.errors(rubbed)),
        "passes_cost": passes.cost(rubbed),
        "passes_agreement": f"{rubbed.agreement:.0e}",
        "rods": rods.ratios.size,
        "masses": "\n".join(masses.lines(rods)),
        "masses_cost": masses.cost(rods),
        "masses_agreement": f"{rods.agreement:.0e}",
        "driven": count * len(steps.KINDS),
        "steps": "\n".join(steps.choices(driven)),
        "forms": "\n".join(steps.forms(driven)),
        "floors": steps.floors(driven),
    }


def write(found: Found, cost: dict[Setting, float], count: int, timed: str = "ten kinds") -> None:
    """Write trade.md and trade.png; `timed` says of how many kinds the costs are."""
    groups = grouped(found)
    fast, strict, apart = knobs.floating_point()
    parts = {
        "machines": count * len(found),
        "each": count,
        "timed": timed,
        "described": "\n".join(described()),
        "choices": "\n".join(choices(groups, cost)),
        "costs": "\n".join(cost_table(cost)),
        "errors": "\n".join(errors_table(groups)),
        "rules": "\n".join(knobs.rules(found, count)),
        "tables": "\n".join(knobs.tables()),
        "floating": f"{fast:.1f} µs a variant with the engine's rules, {strict:.1f} µs strictly by IEEE 754; "
        f"excess works differ by up to {apart:.0e}",
        "system": f"{platform.processor() or platform.machine()}, Python {platform.python_version()}, one thread",
    }
    (HERE / "trade.md").write_text(TEXT.format(**parts, **of_models(count)))
    draw(groups, cost).savefig(HERE / "trade.png", dpi=110)


TEXT = """# Speed against accuracy

{machines} random machines, {each} of each kind, seeds fixed, with transmission angles down to less than a degree:

{described}

True summaries are computed by code that shares nothing with the engine but the scene: closed formulas for circles and
lines, derivatives by truncated Taylor series, extremes, integrals and flywheels from Legendre series on panels between
the places where loads switch, all in 80-bit extended precision (`taylor.py`, `closed_*.py`); `fifty_digits.py` checks
values at extremes with mpmath at 50 digits. Errors of a field's statistics are relative to its peak, places are in
radians, differences of flywheels absolute. Made by `python results/accuracy/trade.py`: {system}.

![error against cost](trade.png)

## What to choose

The cheapest setting that keeps 99 % of the machines within an error, and its time per variant relative to 720
positions in float64. "accuracy" is the key of a study that gives every variant as many positions as it takes.

{choices}

## Costs

Time per variant relative to 720 positions in float64, all summaries of a machine asked at once; median of {timed}.

{costs}

## Errors

Median, 99 % and worst of all machines of a kind of load.

{errors}

## The rule of integration

Excess work from the same moments by other rules; the engine's is the trapezoid rule (exact between positions for
forces over a stroke). 99 % of the machines; times are NumPy's.

{rules}

With jumps and kinks no rule over equally spaced positions is of a higher order than one or two: what helps is to place
positions at the jumps, as `accuracy` does, or to know the work over a stroke exactly, as the engine does. For smooth
loads the error that is left is the extreme between two positions, not the integral: Simpson's rule and harmonics
halve it, searching between positions takes it away.

## Tables

Error of the excess work of a smooth moment of three harmonics given by rows. A table over the crank angle is evaluated
once for all variants; over a stroke all three cost the same, since all are cubics.

{tables}

## Floating-point rules

The engine lets the compiler contract and reassociate; only so are sums over positions vectorised. {floating}.

## Passes of friction

{rubbed} machines with friction in all pairs of their groups, coefficients from 0.01 up to where they jam, sliders on
the frame so short that they may tilt; errors relative to peaks, against passes until nothing changes in 80 bits
(`closed_friction.py`), to which the engine's loss comes within {passes_agreement} (two kinds). The least determinant
of friction's feedback in the cycle (`jamming_margin`) is 1 without friction, 0 where a machine jams.

Passes that keep 99 % of the machines within an error: before the stroke as the engine makes them, which take the
directions of the reactions from the pass before and solve for what presses; after it as textbooks do, which take
friction from the pass before. "–": not in 40.

{passes}

Errors after so many of the engine's passes: median, 99 % and worst.

{passes_errors}

{passes_cost}.

Passes end where no force changes by more than 1e-10. One less costs half of the digits: there is nothing to gain.
By hand, three of the textbooks' passes are enough for 1 % where the
determinant is above 0.9; where it is below 0.5, not even forty.

## Replacement masses

{rods} machines, their rods drawn as in `replacement_masses.py`: what two masses in the joints of the rods miss, the
greatest error over the cycle relative to the peak, median, 99 % and worst. They have the rod's mass and centre, and
m·a·b for its m·k². The engine's `replace` is that to {masses_agreement}; a dynamic replacement is the rod itself to
rounding (`replacement_masses.md`).

{masses}

A variant takes {masses_cost}.

Masses are more bodies to add up: there is nothing to gain but to compute by hand, and then dynamically. Two static
masses are within 1 % of the input moment, the flywheel and δ of 99 % of the machines only where ab is within 10 % of
k²; the shaking force and the excess work of the loads they keep exactly, wherever k² is. Of a given scene
`BODY.replacement_error` tells.

## Steps of true motion

{driven} machines with a flywheel and a DC motor, from so soft that disturbances last 30 cycles to so stiff that they
last a third of one: three cycles from 0.7 of the speed that they are made for, and the motion that repeats itself. True
motion is found by collocation in 80 bits on the panels of the closed formulas (`closed_run.py`). The cheapest steps a
cycle that keep 99 % of the machines within an error (of the multiplier: absolute), and the time of the regime in µs a
variant.

{steps}

The same of the speed and the time after three cycles, by other ways to integrate, restated in NumPy (`ways.py`); in
brackets how often they ask for I and M in a cycle, of steps by tolerance the median with those tried in vain. "–": not
with 1536 steps, in time with 384, by a tolerance of 1e-11. The engine comes as near to the references as {floors}.

{forms}

`positions` is the number of steps. 24 are enough for 1 % of everything, 48 for 0.1 %, 192 for 1e-6, so that the default
of 720 is on the safe side; 768 are for 1e-9 of speeds and times, 1536 of δ. Fewer than 48 save nothing. What counts
with kinks and jumps is the nodes there: without them RK4 takes sixteen times as many steps for 1e-6 with kinks, a
hundred times as many for 0.1 % with jumps, and steps by tolerance ask two to four times as often for 1e-6.
"""


def main() -> None:
    """Measure and write everything."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=100, help="of each kind")
    count = parser.parse_args().machines
    found = measured(count, SETTINGS)
    calibration.write(found, ASKED[:4:3], count * len(found))
    write(found, costs(), count)


if __name__ == "__main__":
    main()
