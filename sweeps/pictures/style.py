"""The look of all pictures, their sizes on paper and their files."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from matplotlib import rc_context
from matplotlib.cbook import is_math_text
from matplotlib.figure import Figure
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, ScalarFormatter

from sweeps.pictures.picture_error import PictureError
from sweeps.text.visible import visible
from sweeps.text.whole_files import whole_file

MM_PER_INCH = 25.4
# Of a screen, to an inch of a figure.
_PIXELS = 96
# Colours that stay apart for the colour-blind (Okabe and Ito).
BLUE, ORANGE, GREEN, VERMILION, PURPLE, SKY = PALETTE = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#d55e00",
    "#cc79a7",
    "#56b4e9",
)
GREY = "#8a8f94"
# Variants that were computed but miss the condition.
PALE = "#c9cdd1"
# Map of colours for numbers.
COLOURS = "cividis"
FORMATS = (".svg", ".pdf", ".png")
_STYLE = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7,
    "figure.titlesize": 10,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.linewidth": 0.4,
    "grid.color": "#d5d8dc",
    "axes.formatter.use_mathtext": True,
    "axes.formatter.limits": (-4, 5),
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "xtick.direction": "in",
    "ytick.direction": "in",
    "hatch.linewidth": 0.5,
    "pdf.fonttype": 42,
    # Text that can be searched, and changed in a drawing program.
    "svg.fonttype": "none",
    # The same picture gives the same file.
    "svg.hashsalt": "machine-sweeps",
    "savefig.dpi": 200,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Fonts, lines and colours of all pictures, for what is made and saved inside."""
    with rc_context(_STYLE):
        yield


class PlainNumbers(ScalarFormatter):
    """Numbers along an axis as plain text; the power of ten at its end stays a formula.

    Matplotlib makes formulas of both, and lays out each formula several times as slowly as a plain text.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Text of one number."""
        return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")


class Sheet(Figure):
    """A figure that a notebook shows as it is saved, without pyplot, which keeps figures until they are closed."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        made = BytesIO()
        _lettered(self)
        with house_style():
            self.savefig(made, format="png")
        width, height = self.get_size_inches()
        return made.getvalue(), {"width": round(_PIXELS * width), "height": round(_PIXELS * height)}


def new_figure(width: float, height: float) -> Figure:
    """Figure of a size on paper [mm]; 180 mm fill the width of A4 between its margins."""
    return Sheet(figsize=(width / MM_PER_INCH, height / MM_PER_INCH), layout="constrained")


def _lettered(figure: Figure) -> None:
    """A title is the user's own, and a $ in it begins no formula; numbers along axes are plain, all texts legible."""
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
                # Texts at ticks are taken from it anew when they are drawn.
                axis.set_major_formatter(FuncFormatter(_legible_texts_of(formatter)))


def _legible_texts_of(formatter: FuncFormatter) -> Callable[[float, int | None], str]:
    return lambda x, pos: _legible(formatter(x, pos))


def _legible(text: str) -> str:
    """A text as `visible` shows it, in which no $ begins a formula that can't be read, as in a foreign result."""
    text = visible(text)
    if is_math_text(text):
        try:
            MathTextParser("path").parse(text)
        except ValueError:
            return text.replace("$", r"\$")
    return text


def save(figure: Figure, path: Path | str) -> None:
    """Save a figure as .svg, .pdf (vector fonts) or .png, the same bytes every time.

    Raises
    ------
    PictureError
        The ending is another one, or the file can't be written.
    """
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise PictureError(f"{path}: ending {ending!r} isn't a picture's; allowed are {', '.join(FORMATS)}")
    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}[ending]
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        _lettered(figure)
        with house_style(), whole_file(path) as draft:
            # Half the time of the usual level 6, files that are 1 % larger.
            packed = {"pil_kwargs": {"compress_level": 4}} if ending == ".png" else {}
            # Made in memory: on a full disk, a file of Matplotlib's own ends in another error than the disk's.
            made = BytesIO()
            figure.savefig(made, format=ending[1:], metadata=undated, **packed)
            draft.write_bytes(made.getbuffer())
    except OSError as error:
        raise PictureError(f"{path} can't be written: {error.strerror}") from None


@contextmanager
def sheet(target: Path | str | Figure, width: float, height: float, title: str = "") -> Iterator[Figure]:
    """A figure of a size on paper [mm] to draw on, in the house's style, then titled and saved.

    Parameters
    ----------
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure that is drawn on instead, and not saved.
    width, height : float
    title : str

    Raises
    ------
    PictureError
        As for `save`.
    """
    with house_style():
        figure = target if isinstance(target, Figure) else new_figure(width, height)
        yield figure
        if title:
            figure.suptitle(title, fontweight="bold")
    if figure is not target:
        save(figure, target)
