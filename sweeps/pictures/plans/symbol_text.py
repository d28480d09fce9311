"""Texts with symbols such as $v_{BA}$, laid out from the advances of their glyphs.

Matplotlib's mathematical text reads each formula by a grammar, which takes longer than all else on a sheet with
hundreds of symbols and values. What symbols of plans are made of — letters, an index, what stands above it — is laid
out here to the same measures; any other formula is left to matplotlib.
"""

import re
from collections.abc import Iterator
from functools import cache, lru_cache
from typing import NamedTuple

from matplotlib import rc_context
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgba
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ft2font import LoadFlags
from matplotlib.text import Text
from matplotlib.transforms import Bbox

_GREEK = {"omega": "ω", "varepsilon": "ε", "rho": "ρ", "mu": "μ"}
_TOKEN = re.compile(r"\\mathrm\{((?:[^{}\\]|\\_)*)\}|\\([a-z]+)|([_^])|(\{)|(\})|([A-Za-z])|('+)|([0-9,.])")
# As in matplotlib with DejaVu Sans: size of an index, and how far it and what stands above it are shifted [em].
_SMALLER, _DOWN, _FARTHER_DOWN, _UP = 0.7, 0.15, 0.309, 0.413
_SPACE_AFTER = 0.03
# Height above the base line and depth below it of a line of text [em].
_ASCENT, _DESCENT = 0.76, 0.24
_EM = 1000


class Run(NamedTuple):
    """Letters of one look: where they begin and how high above the base line, and their size [em of the text]."""

    letters: str
    style: str
    size: float
    right: float
    rise: float


class Line(NamedTuple):
    """A line of text: its runs, its width, how far its ink reaches above the base line and below it [em]."""

    runs: tuple[Run, ...]
    width: float
    above: float
    below: float


class _Glyph(NamedTuple):
    """Measures of a glyph [em]."""

    advance: float
    above: float
    below: float


@cache
def _glyph(letter: str, style: str) -> _Glyph:
    font = get_font(findfont(FontProperties(family="DejaVu Sans", style=style)))
    font.set_size(_EM, 72)
    found = font.load_char(ord(letter), flags=LoadFlags.NO_HINTING)
    top, height = found.horiBearingY / 64, found.height / 64
    return _Glyph(found.linearHoriAdvance / 65536 / _EM, top / _EM, (height - top) / _EM)


@lru_cache(maxsize=4096)
def line_of_symbols(text: str) -> Line | None:
    """Layout of one line; None where it has a formula that isn't a symbol of plans.

    Parameters
    ----------
    text : str
        With formulas between dollar signs.
    """
    runs: list[Run] = []
    right = 0.0
    for i, part in enumerate(text.split("$")):
        if i % 2 == 0:
            right = _set(runs, part, "normal", 1.0, right, 0.0)
            continue
        tokens = _tokens(part)
        if tokens is None:
            return None
        right = _formula(runs, iter(tokens), 1.0, right, 0.0)
    inked = [(run, _glyph(letter, run.style)) for run in runs for letter in run.letters if letter != " "]
    above = max((run.rise + run.size * glyph.above for run, glyph in inked), default=0.0)
    below = max((run.size * glyph.below - run.rise for run, glyph in inked), default=0.0)
    return Line(tuple(runs), right, above, below)


def _tokens(formula: str) -> list[tuple[str, str]] | None:
    """A formula as (letters, what they are): "italic", "normal", "shift", "open", "close"."""
    found, at = [], 0
    for match in _TOKEN.finditer(formula):
        upright, greek, shift, opening, closing, letter, primes, other = match.groups()
        if match.start() != at or (greek is not None and greek not in _GREEK):
            return None
        at = match.end()
        if upright is not None:
            found.append((upright.replace(r"\_", "_"), "normal"))
        elif greek or letter:
            found.append((_GREEK[greek] if greek else letter, "italic"))
        elif primes:
            found.append(("\N{PRIME}" * len(primes), "normal"))
        elif other:
            found.append((other, "normal"))
        else:
            found.append((shift or opening or closing, "shift" if shift else "open" if opening else "close"))
    return found if at == len(formula) else None


def _formula(
    runs: list[Run], tokens: Iterator[tuple[str, str]], size: float, right: float, rise: float, one: bool = False
) -> float:
    """Set tokens up to the end or the closing bracket, or one of them alone; where the next begin [em]."""
    # Where an index and what stands above it begin, and the farther of their ends.
    begin = end = right
    above = False
    for letters, kind in tokens:
        if kind == "close":
            break
        if kind == "shift":
            above = above or letters == "^"
            shift = _UP if letters == "^" else -_FARTHER_DOWN if above else -_DOWN
            stop = _formula(runs, tokens, _SMALLER * size, begin, rise + shift * size, one=True)
            end = max(end, stop + _SPACE_AFTER * size)
            right = end
            continue
        if kind == "open":
            right = _formula(runs, tokens, size, right, rise)
        else:
            right = _set(runs, letters, kind, size, right, rise)
        begin, end, above = right, right, False
        if one:
            break
    return right


def _set(runs: list[Run], letters: str, style: str, size: float, right: float, rise: float) -> float:
    """Set letters, in one run with those before them where these look alike; where the next ones begin [em]."""
    # A blank at the beginning of a text of SVG isn't shown.
    begun = letters.lstrip(" ")
    right += (len(letters) - len(begun)) * size * _glyph(" ", style).advance
    if begun:
        last = runs[-1] if runs else None
        alike = last is not None and (last.style, last.size, last.rise) == (style, size, rise)
        if alike and begun == letters and last.right + size * _advance(last.letters, style) == right:
            runs[-1] = last._replace(letters=last.letters + letters)
            return last.right + size * _advance(runs[-1].letters, style)
        runs.append(Run(begun, style, size, right, rise))
    return right + size * _advance(begun, style)


def _advance(letters: str, style: str) -> float:
    return sum(_glyph(letter, style).advance for letter in letters)


class SymbolText(Text):
    """A text of one or several lines with symbols of plans, not turned; anything else is drawn as matplotlib does.

    Parameters
    ----------
    x, y : float
    text : str
    linespacing : float
        As of matplotlib's texts.
    **look
        As of matplotlib's texts.
    """

    def __init__(self, x: float, y: float, text: str, linespacing: float = 1.2, **look: object) -> None:
        super().__init__(x, y, text, linespacing=linespacing, **look)
        # From one base line to the next [em].
        self._pitch = _ASCENT * linespacing + _DESCENT

    def _lines(self) -> list[Line] | None:
        found = [line_of_symbols(text) for text in self.get_text().split("\n")]
        return None if None in found else found

    def _bottom_left(self, lines: list[Line], em: float) -> tuple[float, float, float, float]:
        """Lower left corner, width and height [pixels]."""
        x, y = self.get_transform().transform(self.get_unitless_position())
        width = em * max(line.width for line in lines)
        top, bottom = (_ASCENT, _DESCENT) if len(lines) > 1 else (lines[0].above, lines[0].below)
        height = em * (top + bottom + (len(lines) - 1) * self._pitch)
        x -= {"left": 0.0, "center": 0.5, "right": 1.0}[self.get_horizontalalignment()] * width
        share = {"bottom": 0.0, "center": 0.5, "top": 1.0}.get(self.get_verticalalignment())
        y -= em * bottom if share is None else share * height
        return float(x), float(y), width, height

    def get_window_extent(self, renderer: RendererBase | None = None, dpi: float | None = None) -> Bbox:
        """Box of the text [pixels]."""
        lines = self._lines()
        if lines is None:
            return super().get_window_extent(renderer, dpi)
        em = self.get_fontsize() * (dpi or self.get_figure(root=True).dpi) / 72
        return Bbox.from_bounds(*self._bottom_left(lines, em))

    def draw(self, renderer: RendererBase) -> None:
        """Draw the runs one after another."""
        lines = self._lines()
        if lines is None:
            super().draw(renderer)
            return
        if not self.get_visible():
            return
        em = renderer.points_to_pixels(self.get_fontsize())
        x, y, width, height = self._bottom_left(lines, em)
        aligned = {"left": 0.0, "center": 0.5, "right": 1.0}[self.get_horizontalalignment()]
        base = y + height - em * (_ASCENT if len(lines) > 1 else lines[0].above)
        upside_down = renderer.get_canvas_width_height()[1] if renderer.flipy() else None
        renderer.open_group("text", self.get_gid())
        gc = renderer.new_gc()
        gc.set_foreground(to_rgba(self.get_color()), isRGBA=True)
        gc.set_alpha(self.get_alpha())
        # Hinted glyphs advance by whole pixels: a long run would reach into the next one.
        with rc_context({"text.hinting": "none"}):
            for line in lines:
                left = x + aligned * (width - em * line.width)
                for run in line.runs:
                    place = base + em * run.rise
                    if upside_down is not None:
                        place = upside_down - place
                    look = self._font_of(run)
                    renderer.draw_text(gc, left + em * run.right, place, run.letters, look, 0.0)
                base -= em * self._pitch
        gc.restore()
        renderer.close_group("text")
        self.stale = False

    def _font_of(self, run: Run) -> FontProperties:
        look = self.get_fontproperties().copy()
        look.set_family("DejaVu Sans")
        if run.style == "italic":
            look.set_style("italic")
        look.set_size(run.size * self.get_fontsize())
        return look
