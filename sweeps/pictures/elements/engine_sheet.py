"""Engine orders: cylinders and throws in end view, and a table."""

import math
from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes

from engine import SHOWN_ORDERS, EngineElement, display_unit, shaken, torque_orders
from sweeps.pictures.style import GREY, VERMILION
from sweeps.report.order_table import LINE, ellipse_text
from sweeps.text.tables import table


def engine_table(engine: EngineElement) -> str:
    """The orders of an engine's forces, couples and torque, as a text table.

    Parameters
    ----------
    engine : EngineElement
    """
    found = shaken(engine)
    kinds = {"force": ("N", found.forces)} | ({} if engine.spacing is None else {"couple": ("N m", found.couples)})
    rows = [("order", *(head for kind in kinds for head in (kind, "with counterweights")))]
    for order in SHOWN_ORDERS:
        cells = [ellipse_text(vector, order, unit) for unit, both in kinds.values() for vector in both]
        if any(cell != "0" for cell in cells) or order in (1, 2, 4, 6):
            rows.append((f"{order}", *cells))
    lines = [table(rows), "Ellipses by their half axes; ↺ turns with the crank, ↻ against it."]
    if engine.gas is not None:
        lines.append(_torque_text(engine))
    return "\n".join(lines)


def _torque_text(engine: EngineElement) -> str:
    steps = np.arange(1, 13) / 2
    mean, parts = torque_orders(engine, steps)
    factor, unit = display_unit("N m", np.array([mean]))
    left = ", ".join(f"{n:g}: {factor * abs(part):.4g}" for n, part in zip(steps, parts, strict=True) if part)
    order = "-".join(map(str, engine.order_of_firing))
    return f"firing order {order}; mean torque {factor * mean:.4g} {unit}, torque orders [{unit}] {left or 'none'}"


def _together(angles: Iterable[float]) -> dict[float, str]:
    """Cylinder numbers with equal angles [rad]."""
    found: dict[float, list[str]] = {}
    for k, angle in enumerate(angles, 1):
        turned = float(angle) % math.tau
        same = next((a for a in found if abs((a - turned + math.pi) % math.tau - math.pi) < LINE), turned)
        found.setdefault(same, []).append(str(k))
    return {
        angle: ", ".join(numbers) if len(numbers) < 7 else f"{numbers[0]} … {numbers[-1]}"
        for angle, numbers in found.items()
    }


def engine_front(ax: Axes, engine: EngineElement) -> None:
    """End view of banks and throws, the engine's axis upwards, the crank at 0."""
    layout = engine.nominal_layout
    for angles, length, look, label in (
        (layout.banks, 1.1, {"color": GREY, "linewidth": 5, "alpha": 0.5, "solid_capstyle": "butt"}, "cylinders"),
        (layout.throws, 0.45, {"color": VERMILION, "linewidth": 1.6}, "throws"),
    ):
        for i, (angle, numbers) in enumerate(_together(angles).items()):
            way = 1j * np.exp(1j * angle)
            begin, tip = way * (0.78 if length > 1 else 0.0), way * length
            ax.plot([begin.real, tip.real], [begin.imag, tip.imag], label=None if i else label, **look)
            place = way * (length + 0.17)
            ax.text(place.real, place.imag, numbers, ha="center", va="center", fontsize=7, color=look["color"])
    ax.plot(0, 0, "o", color="black", markersize=3)
    ax.set(aspect="equal", xlim=(-1.4, 1.4), ylim=(-1.4, 1.4), xticks=[], yticks=[])
    for side in ax.spines.values():
        side.set_visible(False)
    ax.set_title("Cylinders, throws (orange), crank at 0")
