"""Figures of the report: machine and variants as SVG, and data for the page's script."""

import base64
import json
import re
import shlex
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from engine import SceneError, common_units, scene_numbers
from sweeps.page.digest import Digest
from sweeps.page.machine_motion import BRIEF, looks, motion_data
from sweeps.page.page_text import SHORT, markup
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.picture_files import machine_pictures
from sweeps.pictures.style import COLOURS, save, wrapped
from sweeps.pictures.sweep.maps import plot_result
from sweeps.pictures.sweep.parallel_coordinates import chosen_columns
from sweeps.pictures.sweep.result_pictures import plot_data, sweep_figure
from sweeps.pictures.sweep.sweep_data import SweepData
from sweeps.text.visible import visible
from sweeps.text.whole_files import scratch_folder

if TYPE_CHECKING:
    from markupsafe import Markup

# Sweeps up to this size are drawn completely, as curves or a map.
DRAWN_WHOLE = 20_000
# Machines in motion on a page: how many, how many of the best, and their size as text.
MOST_MACHINES, MOST_LEADERS, MOST_MOTION = 60, 20, 800_000
# Shade of variants that miss the condition.
MISSED = -0.5


class Drawn(NamedTuple):
    """Figures of the report.

    Attributes
    ----------
    machine : list of Markup
        Drawing and diagrams.
    variants : Markup or None
        All variants in one static figure.
    complaints : list of str
        Figures that can't be drawn, and why.
    """

    machine: list["Markup"]
    variants: "Markup | None"
    complaints: list[str]


def drawn_pictures(digest: Digest) -> Drawn:
    """Draw the machine with its diagrams, and all variants."""
    machine, variants, complaints = [], None, []
    with scratch_folder() as folder:
        if digest.drawn is not None:
            try:
                made = machine_pictures(digest.result.scene_of(digest.drawn), folder / "machine.svg")
                machine = [inline_svg(picture, f"m{k}") for k, picture in enumerate(made)]
            except PictureError as error:
                complaints.append(f"No drawing of the machine: {error}")
        if not digest.is_one:
            path = folder / "variants.svg"
            try:
                save(_variants_drawn(digest), path)
                variants = inline_svg(path, "v")
            except PictureError as error:
                complaints.append(f"No plot of the variants: {error}")
    return Drawn(machine, variants, complaints)


def _variants_drawn(digest: Digest) -> Figure:
    result = digest.result
    if result.file.variants <= DRAWN_WHOLE:
        return sweep_figure(result, None, None, None, digest.best)
    best = None if digest.best is None else int(np.searchsorted(digest.shown, digest.best))
    return plot_result(_data_of(digest), best=best)


def _data_of(digest: Digest) -> SweepData:
    """Plot data of the variants in the figures."""
    return plot_data(digest.result, digest.rows, (digest.shown.size,), digest.aim, digest.meets)


def inline_svg(path: Path, prefix: str) -> "Markup":
    """An SVG for embedding: without its header, its ids made unique.

    Parameters
    ----------
    path : Path
        SVG file.
    prefix : str
        Prefix of its ids.
    """
    text = path.read_text("utf8")
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(r"(?<=data:image/png;base64,)[^\"]*", _of_few_colours, text)
    return markup(re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", text))


def _of_few_colours(found: re.Match) -> str:
    """A raster picture with a palette, which is a fraction of the size of one in full colour."""
    made = BytesIO()
    with Image.open(BytesIO(base64.b64decode(found[0]))) as picture:
        picture.quantize(method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(made, "png", optimize=True)
    return base64.b64encode(made.getvalue()).decode()


def variants_data(digest: Digest) -> dict[str, Any] | None:
    """The variants as data for the page's script; None if nothing varies.

    Parameters
    ----------
    digest : Digest

    Returns
    -------
    dict
        `columns` (name, label, wrapped label, values in an engineer's unit; of the scene's numbers also the exact ones
        with their unit in a scene), those `plotted`, `numbers` of the variants, `shades` (0 to 1; −0.5 if the condition
        is missed), `colours` of these from 0, `axes` (x and y columns), `goal` (a column), `best` (index or None),
        `file` for a shell.
    """
    data = _data_of(digest)
    shade = digest.aim.goal if digest.aim else next(iter(data.summaries), None)
    if shade is None:
        return None
    plotted = chosen_columns(data, shade)
    if shade not in plotted:
        return None
    names = [*plotted, *(name for name in (*digest.result.parameters, *data.summaries) if name not in plotted)]
    shown = {name: data.shown(name) for name in names}
    finite = np.flatnonzero(np.isfinite([shown[name][0] for name in plotted]).all(axis=0))
    # Variants that miss the condition come first, so that they hide none of the others.
    finite = finite[np.argsort(data.candidates[finite], kind="stable")]
    dimensions = {path: number.dimension for path, number in scene_numbers(digest.result.scene).items()}
    columns = []
    for name, (values, label, _) in shown.items():
        # Browsers don't typeset TeX symbols.
        label = visible(re.sub(r" *\$[^$]*\$", "", label)).replace(".\n", ".").replace("\n", " ")
        rounded = [float(f"{value:.6g}") if np.isfinite(value) else None for value in values[finite]]
        column = {"name": visible(name), "label": label, "lines": wrapped(label, 16), "values": rounded}
        if name in digest.result.parameters and name in dimensions:
            dimension = dimensions[name]
            column["unit"] = None if dimension == "number" else common_units(dimension)[-1]
            column["exact"] = data.arrays[name][finite].tolist()
        columns.append(column)
    shades, met, numbers = shown[shade][0][finite], data.candidates[finite], digest.shown[finite]
    scale = shades[met] if met.any() else shades
    span = (np.ptp(scale) if scale.size else 0.0) or 1.0
    heights = np.where(met, (shades - scale.min(initial=np.inf)) / span, MISSED)
    best = next(iter(np.flatnonzero(numbers == digest.best).tolist()), None)
    return {
        "columns": columns,
        "plotted": list(range(len(plotted))),
        "numbers": numbers.tolist(),
        "shades": [round(float(height), 4) for height in heights],
        "colours": [to_hex(colour) for colour in colormaps[COLOURS](np.linspace(0, 1, 12))],
        "axes": [0, names.index(shade)],
        "goal": names.index(shade),
        "best": best,
        "file": visible(shlex.quote(digest.result.path.name)),
    }


def machines_data(digest: Digest) -> dict[str, Any] | None:
    """Machines in motion as data for the page's script: the drawn variant, then others; None if it can't be drawn.

    Others are the best ones, the front, and a sample, as many as fit on the page.

    Parameters
    ----------
    digest : Digest
    """
    first = digest.drawn
    if first is None or digest.result.scene.input is None:
        return None
    machines, room = [], MOST_MOTION
    for number in dict.fromkeys([first, *([] if digest.is_one else _carried(digest))]):
        try:
            motion = DrawnMotion(digest.result.scene_of(number))
            machine = motion_data(motion, BRIEF, arrows=False) if machines else motion_data(motion)
        except (PictureError, SceneError):
            if not machines:
                return None
            continue
        room -= len(json.dumps(machine, separators=SHORT))
        if machines and room < 0:
            break
        name = digest.result.file.title if digest.is_one else f"Variant {number}"
        machines.append({"number": number, "name": visible(name), **machine})
    return {"looks": looks(), "machines": machines}


def _carried(digest: Digest) -> list[int]:
    """Variants to draw as far as they fit, the most important first."""
    shown = digest.shown[digest.meets]
    sample = shown[np.linspace(0, shown.size - 1, min(MOST_MACHINES, shown.size)).astype(int)]
    found = [*digest.leaders[:MOST_LEADERS], *digest.front[:MOST_LEADERS], *sample]
    return [int(number) for number in dict.fromkeys(found)][:MOST_MACHINES]
