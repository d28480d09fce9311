"""How true the error figures are: the share of true errors that they cover, and how far they lie above them.

Written by `trade.py` with everything else that is measured on random machines:

    python results/accuracy/trade.py
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from measured import Found, Setting
from quantities import class_of, loads_of

HERE = Path(__file__).parent
POSITIONS = (48, 96, 360, 720)
PRECISIONS = ("float64", "float32")


class Scatter(NamedTuple):
    """True errors and error figures, relative, of one group of summaries."""

    errors: np.ndarray
    figures: np.ndarray

    @property
    def covered(self) -> float:
        """Share of true errors that their figures cover, %."""
        return 100 * float(np.mean(self.errors <= self.figures))

    @property
    def ratio(self) -> float:
        """Median of figure over true error."""
        with np.errstate(divide="ignore"):
            return float(np.median(self.figures / self.errors))


def scattered(found: Found, setting: Setting) -> dict[str, Scatter]:
    """True errors and figures by group of summaries; where the speed is as asked, there is no true error."""
    groups: dict[str, list[np.ndarray]] = {}
    for by_setting in found.values():
        summaries = by_setting[setting]
        sized = "flywheel_wittenbauer" in summaries
        for name, e in summaries.items():
            if sized and name.startswith("speed_"):
                continue
            known = np.isfinite(e.errors) & (e.scales > 0)
            both = np.stack([np.maximum(e.errors - e.doubts, 0), e.figures]) / np.where(e.scales > 0, e.scales, 1)
            groups.setdefault(class_of(name), []).append(both[:, known])
    return {name: Scatter(*np.concatenate(parts, axis=1)) for name, parts in sorted(groups.items())}


def together(scatters: dict[str, Scatter]) -> Scatter:
    """All groups as one."""
    return Scatter(*(np.concatenate(parts) for parts in zip(*scatters.values(), strict=True)))


def _cell(scatter: Scatter | None) -> str:
    if scatter is None:
        return "–"
    return (
        f"{scatter.covered:.2f} % ({scatter.ratio:.2g})" if scatter.ratio < 1e4 else f"{scatter.covered:.2f} % (> 1e4)"
    )


def table(found: Found, precision: str, accuracies: tuple[Setting, ...] = ()) -> list[str]:
    """Lines of the table of one precision."""
    settings = [*(Setting(n, precision) for n in POSITIONS), *accuracies]
    columns = [scattered(found, setting) for setting in settings]
    lines = [f"| {precision} | " + " | ".join(s.label.removesuffix(", float32") for s in settings) + " |"]
    lines.append("|---" * (len(settings) + 1) + "|")
    for name in columns[0]:
        lines.append(f"| {name} | " + " | ".join(_cell(column.get(name)) for column in columns) + " |")
    lines.append("| **all** | " + " | ".join(_cell(together(column)) for column in columns) + " |")
    return lines


def uncovered(found: Found, setting: Setting, count: int) -> list[str]:
    """Lines of the worst true errors beyond their figures."""
    rows = []
    for kind, by_setting in found.items():
        for name, e in by_setting[setting].items():
            if "flywheel_wittenbauer" in by_setting[setting] and name.startswith("speed_"):
                continue
            with np.errstate(all="ignore"):
                beyond = np.where(e.errors > e.figures + e.doubts, (e.errors - e.doubts) / e.scales, -1)
            k = int(np.argmax(np.nan_to_num(beyond, nan=-1)))
            if beyond[k] > 0:
                rows.append((float(beyond[k]), kind, name, k, e.errors[k], e.figures[k], np.count_nonzero(beyond > 0)))
    rows.sort(reverse=True)
    return [
        f"| {kind} | {name} | {k} | {error:.3g} | {figure:.3g} | {many} |"
        for _, kind, name, k, error, figure, many in rows[:count]
    ]


def write(found: Found, accuracies: tuple[Setting, ...], machines: int) -> None:
    """Write calibration.md and calibration.png."""
    lines = [TEXT.format(machines=machines, kinds=len(found)), *table(found, "float64", accuracies), ""]
    lines += [*table(found, "float32"), "", WORST, "", "| machine | summary | variant | error | figure | such |"]
    lines += ["|---|---|---|---|---|---|", *uncovered(found, Setting(720), 12), ""]
    (HERE / "calibration.md").write_text("\n".join(lines))
    draw(found).savefig(HERE / "calibration.png", dpi=110)


TEXT = """# Error figures against true errors

{machines} random machines of {kinds} structures (see `trade.md`). Every cell: the share of true errors that are no
greater than their error figure, and in brackets the median of figure over true error.

Where a row is smooth about an extreme, the figure is four times what the next two differences add to the polynomial
that the extreme is taken from, and no less than an eighth of its change from half the positions; where it bends or
jumps, the extreme is that of the positions, and what may hide beside it counts whole. Means of what is smooth and
periodic converge faster than any power of the step: once they have settled, both error and figure are rounding, the
figure with a margin. So it is with panels, which are far nearer than asked.

![figures against errors](calibration.png)
"""

WORST = (
    "Where a figure at 720 positions fell short most, relative to the size of the quantity, and for how many machines:"
)


def draw(found: Found) -> Figure:
    """Figures over true errors, for each kind of load."""
    figure = Figure(figsize=(12, 4.6), layout="constrained")
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    random = np.random.default_rng(0)
    for ax, loads in zip(axes, ("smooth", "kinks", "jumps"), strict=True):
        some = {kind: by for kind, by in found.items() if loads_of(kind) == loads}
        for precision, colour in (("float32", "tab:orange"), ("float64", "tab:blue")):
            for n in (48, 720):
                all_of = together(scattered(some, Setting(n, precision)))
                pick = random.permutation(all_of.errors.size)[:3000]
                label = f"{n} positions, {precision}"
                dots = {"s": 3, "alpha": 0.35, "lw": 0, "color": colour, "marker": "o" if n == 720 else "^"}
                ax.scatter(np.maximum(all_of.errors[pick], 1e-18), all_of.figures[pick], label=label, **dots)
        ax.plot([1e-18, 10], [1e-18, 10], "k", lw=0.8)
        ax.plot([1e-18, 1], [1e-17, 10], "k:", lw=0.8)
        ax.set(xscale="log", yscale="log", xlim=(1e-18, 3), ylim=(1e-18, 10), title=f"loads: {loads}")
        ax.set_xlabel("true error, relative")
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("error figure, relative")
    axes[0].legend(markerscale=3, loc="upper left", fontsize=8)
    return figure
