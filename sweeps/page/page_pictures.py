"""Figures of the report: machine and variants as SVG, and data for the linked figures."""

import html
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from sweeps.optimising.optimum import is_front
from sweeps.page.digest import Digest
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.picture_files import machine_pictures
from sweeps.pictures.style import COLOURS
from sweeps.pictures.sweep.front_picture import front_picture
from sweeps.pictures.sweep.maps import plot_result
from sweeps.pictures.sweep.parallel_coordinates import chosen_columns
from sweeps.pictures.sweep.result_pictures import sweep_data
from sweeps.pictures.sweep.sweep_data import SweepData, wrapped
from sweeps.study.sensitivity import RSS, WORST_CASE
from sweeps.text.visible import visible
from sweeps.text.whole_files import scratch_folder

if TYPE_CHECKING:
    from markupsafe import Markup

# Sweeps up to this size are drawn completely, as curves or a map.
DRAWN_WHOLE = 20_000
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
            scene, path = digest.result.scene, folder / "machine.svg"
            try:
                made = machine_pictures(scene, digest.values(digest.drawn), path)
                machine = [inline_svg(picture, f"m{k}") for k, picture in enumerate(made)]
            except PictureError as error:
                complaints.append(f"No drawing of the machine: {error}")
        if not digest.is_one:
            path = folder / "variants.svg"
            try:
                _draw_variants(digest, path)
                variants = inline_svg(path, "v")
            except PictureError as error:
                complaints.append(f"No plot of the variants: {error}")
    return Drawn(machine, variants, complaints)


def _draw_variants(digest: Digest, path: Path) -> None:
    result = digest.result
    if result.description.variants <= DRAWN_WHOLE:
        data, best = sweep_data(result, (), digest.best)
        if "search" in result.record and is_front(result):
            front_picture(result, data, path)
        else:
            plot_result(data, path, best=best)
        return
    data, best = _data_of(digest), digest.best
    plot_result(data, path, best=None if best is None else int(np.searchsorted(digest.shown, best)))


def _data_of(digest: Digest) -> SweepData:
    """Plot data of the variants in the figures."""
    result, places, aim = digest.result, digest.shown_places, digest.aim
    alone = (name for name in result.summaries if not name.endswith((WORST_CASE, RSS)))
    return SweepData(
        {name: column[places] for name, column in digest.rows.items()},
        result.units,
        result.long_names,
        result.varied,
        sorted(alone, key=lambda name: aim is None or name != aim.goal),
        (places.size,),
        digest.rows["status"][places],
        condition=aim.condition if aim else "",
        candidates=digest.meets[places],
    )


def inline_svg(path: Path, prefix: str) -> "Markup":
    """An SVG for embedding: without its header, its ids made unique.

    Parameters
    ----------
    path : Path
        SVG file.
    prefix : str
        Prefix of its ids.
    """
    from markupsafe import Markup

    text = path.read_text("utf8")
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    return Markup(re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", text))


def linked_data(digest: Digest) -> dict[str, Any] | None:
    """The variants as data for the page's script; None if nothing varies.

    Parameters
    ----------
    digest : Digest

    Returns
    -------
    dict
        `columns` (label, wrapped label as markup, values in an engineer's unit), `numbers` of the variants, `shades`
        (0 to 1; −0.5 if the condition is missed), `colours` of these from 0, `axes` (x and y columns), `best` (index
        or None).
    """
    data = _data_of(digest)
    shade = digest.aim.goal if digest.aim else next(iter(data.summaries), None)
    if shade is None:
        return None
    names = chosen_columns(data, shade)
    if shade not in names:
        return None
    shown = {name: data.shown(name) for name in names}
    finite = np.flatnonzero(np.isfinite([values for values, _, _ in shown.values()]).all(axis=0))
    # Variants that miss the condition come first, so that they hide none of the others.
    finite = finite[np.argsort(data.candidates[finite], kind="stable")]
    columns = []
    for values, label, _ in shown.values():
        # Browsers don't typeset TeX symbols.
        label = visible(re.sub(r" *\$[^$]*\$", "", label)).replace(".\n", ".").replace("\n", " ")
        lines = "<br>".join(html.escape(line) for line in wrapped(label, 16))
        rounded = [float(f"{value:.6g}") for value in values[finite]]
        columns.append({"label": label, "lines": lines, "markup": html.escape(label), "values": rounded})
    shades, met, numbers = shown[shade][0][finite], data.candidates[finite], digest.shown[finite]
    scale = shades[met] if met.any() else shades
    span = (np.ptp(scale) if scale.size else 0.0) or 1.0
    heights = np.where(met, (shades - scale.min(initial=np.inf)) / span, MISSED)
    best = next(iter(np.flatnonzero(numbers == digest.best).tolist()), None)
    return {
        "columns": columns,
        "numbers": numbers.tolist(),
        "shades": [round(float(height), 4) for height in heights],
        "colours": [to_hex(colour) for colour in colormaps[COLOURS](np.linspace(0, 1, 12))],
        "axes": [0, names.index(shade)],
        "best": best,
    }
