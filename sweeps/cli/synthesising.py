"""The synthesise command: mechanisms from their requirements."""

from collections.abc import Callable
from pathlib import Path
from shlex import quote

import click

import engine
from sweeps.cli import needed
from sweeps.cli.shared import Options, in_options, main, tell, with_options, write_text
from sweeps.cli.waiting import doing

_RATIO = click.option(
    "--ratio",
    required=True,
    type=float,
    help="Quick-return ratio K: time of the slow stroke over that of the fast one.",
)
_common = with_options(
    click.option("--speed", default="60 rpm", show_default=True, help="Crank speed."),
    click.option("--out", type=click.Path(path_type=Path), help="Scene to write; default: KIND.toml."),
)


@main.group()
def synthesise() -> None:
    """Synthesise a mechanism from its requirements and write its scene."""


@synthesise.command("slider-crank")
@click.option("--stroke", required=True, help="Stroke of the slider, '300 mm'.")
@_RATIO
@click.option("--rod", help="Rod length, '400 mm' (default: for the best transmission angle).")
@_common
def slider_crank_command(stroke: str, ratio: float, rod: str | None, speed: str, out: Path | None) -> None:
    """Offset slider-crank with a given stroke and quick-return ratio."""
    wanted = _number("--stroke", stroke)
    found = needed.quick_slider_crank(wanted, ratio, None if rod is None else _number("--rod", rod))
    _write(out or Path("slider_crank.toml"), lambda: needed.slider_crank_text(found, wanted, ratio, _speed(speed)))


@synthesise.command("crank-rocker")
@click.option("--swing", required=True, help="Swing of the rocker, '60 deg'.")
@click.option("--rocker", required=True, help="Rocker length, '140 mm'.")
@_RATIO
@click.option("--coupler", help="Coupler length, '200 mm' (default: for the best transmission angle).")
@_common
@in_options
def crank_rocker_command(asked: Options) -> None:
    """Crank-rocker with a given swing and quick-return ratio."""
    angle, ratio = _number("--swing", asked.swing, "angle"), asked.ratio
    coupler = None if asked.coupler is None else _number("--coupler", asked.coupler)
    found = needed.quick_crank_rocker(_number("--rocker", asked.rocker), angle, ratio, coupler)
    _write(
        asked.out or Path("crank_rocker.toml"),
        lambda: needed.crank_rocker_text(found, angle, ratio, _speed(asked.speed)),
    )


@synthesise.command("shaper")
@click.option("--stroke", required=True, help="Stroke of the ram, '300 mm'.")
@_RATIO
@click.option("--frame", required=True, help="Distance between the crank and lever bearings, '240 mm'.")
@_common
def shaper_command(stroke: str, ratio: float, frame: str, speed: str, out: Path | None) -> None:
    """Crank-shaper (slotted lever and ram) with a given stroke and quick-return ratio."""
    wanted = _number("--stroke", stroke)
    found = needed.quick_lever(wanted, ratio, _number("--frame", frame))
    _write(out or Path("shaper.toml"), lambda: needed.lever_text(found, wanted, ratio, _speed(speed)))


@synthesise.command("positions")
@click.option(
    "--at", "places", multiple=True, metavar="'X, Y, ANGLE'", help="A position, '40 mm, 25 mm, 20 deg'; 3 or 4."
)
@click.option("--pivot", "pivots", multiple=True, metavar="'X, Y'", help="Frame pivot, for three positions.")
@click.option(
    "--joint", "joints", multiple=True, metavar="'X, Y'", help="Joint on the moving plane, in its first position."
)
@click.option(
    "--turn", "turns", multiple=True, metavar="'ANGLE, 1'", help="Rotation of a link to the second of four positions."
)
@_common
@in_options
def positions_command(asked: Options) -> None:
    """Four-bar linkage whose coupler passes through given positions in order.

    Three positions: give two links by --pivot or --joint; the first is the crank. Four positions: give two links on the
    Burmester curves by --turn, the rotation from the first position to the second, with the solution number 1 or 2.
    Without --turn, the linkage with the best transmission angle on a grid is chosen.
    """
    rows = [needed.numbers_in_row("--at", text, ("length", "length", "angle")) for text in asked.places]
    positions = [needed.PlanePosition(complex(x, y), angle) for x, y, angle in rows]
    chosen = asked.pivots, asked.joints, asked.turns
    if len(positions) == 4 and not any(chosen):
        found = needed.best_four_bar_through(positions)
    else:
        found = needed.four_bar_through(positions, *needed.chosen_links(positions, *chosen))
    _write(asked.out or Path("positions.toml"), lambda: needed.positions_text(found, _speed(asked.speed)))


@synthesise.command("path")
@click.argument("table", type=click.Path(path_type=Path))
@click.option(
    "--seed", default=0, show_default=True, help="Random seed of the search; other seeds may find other linkages."
)
@_common
def path_command(table: Path, seed: int, speed: str, out: Path | None) -> None:
    """Crank-rocker whose coupler point follows a closed path as closely as possible.

    TABLE is a CSV with the columns `x [mm]` and `y [mm]`: points on the path in order.
    """
    x, y = needed.named_columns(table, {"x": "length", "y": "length"}, "x [mm], y [mm]")
    given = _speed(speed)
    with doing("Searching"):
        found = needed.four_bar_along([complex(*place) for place in zip(x, y, strict=True)], seed)
    headers = (f"1 {column.unit}" for column in needed.read_csv(table).values() if column.unit)
    _write(out or Path("path.toml"), lambda: needed.path_text(found, len(x), given), *headers)


def _number(option: str, text: str, dimension: str = "length") -> float:
    return needed.numbers_in_row(option, text, (dimension,))[0]


def _texts(value: object) -> tuple[str, ...]:
    """The texts of an option."""
    return value if isinstance(value, tuple) else (value,) if isinstance(value, str) else ()


def _speed(text: str) -> str:
    """Check that the text is a speed."""
    _number("--speed", text, "angular_speed")
    return text


def _write(out: Path, text: Callable[[], str], *quantities: str) -> None:
    """Write a scene in the units used by the command's options and by further quantities."""
    given = [text for value in click.get_current_context().params.values() for text in _texts(value)]
    engine.show_units_of({"given": [part.strip() for text in (*given, *quantities) for part in text.split(",")]})
    write_text(out, text())
    tell(f"Wrote {out}: sweeps check {quote(str(out))}; sweeps plot {quote(str(out))}")
