"""Style, paper size and files of all plots."""

import re
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib import rc_context, rc_params_from_file
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.cbook import is_math_text
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend_handler import HandlerPathCollection
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, MultipleLocator, ScalarFormatter

from sweeps.pictures.picture_error import PictureError
from sweeps.text.visible import visible
from sweeps.text.whole_files import new_file

MM_PER_INCH = 25.4
NO_BREAK = "\N{NO-BREAK SPACE}"
# Values whose range is a smaller share of their size are constant.
_CONSTANT = 1e-9
# Screen resolution.
_PIXELS = 96
# Colours for the colour-blind (Okabe and Ito).
PALETTE = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9")
BLUE, ORANGE, GREEN, VERMILION, PURPLE, SKY = PALETTE
GREY = "#8a8f94"
# Variants that were computed but miss the condition.
PALE = "#c9cdd1"
# Colour map.
COLOURS = "cividis"
FORMATS = (".svg", ".pdf", ".png")
_STYLE = rc_params_from_file(Path(__file__).with_name("house.mplstyle"), use_default_template=False)


def house_style() -> AbstractContextManager[None]:
    """Context with the fonts, lines and colours of all plots."""
    return rc_context(_STYLE)


class PlainNumbers(ScalarFormatter):
    """Axis numbers as plain text; only the power of ten stays a formula.

    Matplotlib makes both formulas, whose layout is several times slower.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Text of one number."""
        return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")


class Sheet(Figure):
    """A figure for notebooks without pyplot, which keeps figures until they are closed."""

    def draw(self, renderer: RendererBase) -> None:
        """Draw, except in the first of the two draws of a saving, of which Matplotlib needs only the layout."""
        layout = self.get_layout_engine()
        if self.axes and self.canvas.is_saving() and isinstance(layout, ConstrainedLayoutEngine):
            layout.execute(self)
        else:
            super().draw(renderer)

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        made = BytesIO()
        _lettered(self)
        with house_style():
            self.savefig(made, format="png")
        width, height = self.get_size_inches()
        return made.getvalue(), {"width": round(_PIXELS * width), "height": round(_PIXELS * height)}


def new_figure(width: float, height: float) -> Figure:
    """Figure of a size on paper [mm]; 180 mm is the text width of A4."""
    return Sheet(figsize=(width / MM_PER_INCH, height / MM_PER_INCH), layout="constrained")


def _lettered(figure: Figure) -> None:
    """Set a title literally ($ starts no formula), plain axis numbers and legible texts."""
    for text in figure.findobj(Text):
        if (shown := _legible(text.get_text())) != text.get_text():
            text.set_text(shown)
    for text in figure.texts:
        if text.get_text() == figure.get_suptitle():
            text.set_parse_math(False)
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            formatter = axis.get_major_formatter()
            if type(formatter) is ScalarFormatter:
                with house_style():
                    axis.set_major_formatter(PlainNumbers())
            elif isinstance(formatter, FuncFormatter):
                # Tick texts are recreated on drawing.
                axis.set_major_formatter(FuncFormatter(lambda x, pos, texts=formatter: _legible(texts(x, pos))))


def _legible(text: str) -> str:
    """A `visible` text without invalid formulas."""
    text = visible(text)
    try:
        # Matplotlib typesets each line separately.
        for line in text.splitlines():
            if is_math_text(line):
                MathTextParser("path").parse(line)
    except ValueError:
        return text.replace("$", r"\$")
    return text


def degree_ticks(axis: Axis, span: float) -> None:
    """Tick an axis of angles at common parts of a turn, depending on its length [deg]."""
    axis.set_major_locator(MultipleLocator(next(s for s in (10, 30, 60, 90, 180) if span <= 6 * s or s == 180)))


def scaled_as_constant(ax: Axes, values: np.ndarray) -> bool:
    """Whether values are constant except for rounding; then set a scale that doesn't magnify it."""
    values = values[np.isfinite(values)]
    if not values.size or np.ptp(values) > _CONSTANT * np.abs(values).max():
        return False
    ax.set_ylim(values[0] + 0.1 * (abs(values[0]) or 10.0) * np.array([-1.0, 1.0]))
    return True


def format_of(path: Path | str) -> str:
    """Extension of a picture file.

    Raises
    ------
    PictureError
        Unknown extension.
    """
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise PictureError(f"{path}: unknown picture format {ending!r}; allowed: {', '.join(FORMATS)}")
    return ending


def save(figure: Figure, path: Path | str) -> None:
    """Save a figure as .svg, .pdf (vector fonts) or .png, the same bytes every time.

    Raises
    ------
    PictureError
        Unknown extension, or the file can't be written.
    """
    ending = format_of(path)
    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}[ending]
    # Half the time of level 6, 1 % larger files.
    packed = {"pil_kwargs": {"compress_level": 4}} if ending == ".png" else {}
    _lettered(figure)
    # Written via memory: on a full disk Matplotlib would hide the disk's error.
    made = BytesIO()
    with house_style():
        figure.savefig(made, format=ending[1:], metadata=undated, **packed)
    with new_file(path, PictureError.of) as draft:
        draft.write_bytes(made.getbuffer())


def save_beside(path: Path, figures: Iterable[tuple[str, Figure]]) -> list[Path]:
    """Save figures to files whose names are that of `path` with other words appended; errors as for `save`.

    Parameters
    ----------
    path : Path
    figures : iterable of (str, Figure)
        Words and figure; each is saved before the next one is made.
    """
    made = []
    for words, figure in figures:
        rest = words.removeprefix(f"{path.stem}_")
        # Words that begin with the file's name, engine, may belong to another element, engine_b.
        made.append(path.with_name(f"{path.stem}_{words if '_' in rest else rest}{path.suffix}"))
        save(figure, made[-1])
    return made


@contextmanager
def sheet(width: float, height: float, title: str = "") -> Iterator[Figure]:
    """A styled figure of a size on paper [mm] to draw on, titled on exit."""
    with house_style():
        figure = new_figure(width, height)
        yield figure
        if title:
            figure.suptitle(title, fontweight="bold")


def remark(ax: Axes, words: str) -> None:
    """Small words above the right end of axes."""
    ax.set_title(words, fontsize=7, loc="right", color=GREY)


def titled(title: str, words: str) -> str:
    """Title of a sheet: that of its machine, if it has one, and some words."""
    return f"{title}: {words}" if title else words[:1].upper() + words[1:]


def legend_below(figure: Figure, axes: Iterable[Axes], columns: int) -> None:
    """One legend for all panels, below them; nothing if none of them has a label."""
    entries = {label: handle for ax in axes for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    if entries:
        # Legend dots have a minimum size.
        dots = {PathCollection: HandlerPathCollection(sizes=[14])}
        place = {"loc": "outside lower center", "ncols": min(len(entries), columns)}
        figure.legend(entries.values(), entries.keys(), handler_map=dots, **place)


def typeset(symbol: str) -> str:
    """A symbol of the register, such as "M_in", for Matplotlib."""
    letter, _, index = symbol.partition("_")
    index = index.replace("_", r"\_")
    return rf"${letter}_\mathrm{{{index}}}$" if index else symbol


def wrapped(text: str, width: int) -> list[str]:
    """Lines of at most `width` characters, broken at blanks and after dots and underscores; longer words stay whole."""
    lines = [""]
    for piece in re.split(r"(?<=[._])(?=[^\W\d])|(?<= )", text):
        if lines[-1] and len((lines[-1] + piece).rstrip()) > width:
            lines.append("")
        lines[-1] += piece
    return [line.rstrip() for line in lines]
