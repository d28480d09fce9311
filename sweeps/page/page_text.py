"""The page as text: its template with styles, scripts and data."""

from collections.abc import Mapping
from functools import cache, partial
from importlib.resources import files
from typing import TYPE_CHECKING

from sweeps.text.input_files import InputError
from sweeps.text.versions import extra
from sweeps.text.visible import visible

if TYPE_CHECKING:
    from jinja2 import Template
    from markupsafe import Markup

_EXTRA = partial(extra, "report", "a page", partial(InputError.of, "report"))

# Separators of JSON without blanks.
SHORT = (",", ":")


def page_text(parts: Mapping[str, object]) -> str:
    """Text of a self-contained HTML page.

    Parameters
    ----------
    parts : mapping of str to object
        By the names in the template; absent or empty parts are omitted.

    Raises
    ------
    InputError
        Jinja2 isn't installed.
    """
    template = _template()
    here = files("sweeps.page")
    names = ("page.js", "player.js", "variants.js", *(("watch.js",) if "version" in parts else ()))
    scripts = [markup((here / name).read_text("utf8")) for name in names]
    return template.render(parts, css=markup((here / "page.css").read_text("utf8")), scripts=scripts)


def markup(text: str) -> "Markup":
    """A text that the template embeds as it is.

    Parameters
    ----------
    text : str
        HTML, SVG, a script or a style sheet.

    Raises
    ------
    InputError
        Jinja2 isn't installed.
    """
    with _EXTRA():
        from markupsafe import Markup

    return Markup(text)


@cache
def _template() -> "Template":
    """The template, compiled once: a watched page is made again whenever its file is saved."""
    with _EXTRA():
        import jinja2

    environment = jinja2.Environment(autoescape=True, finalize=_shown)
    environment.policies["json.dumps_kwargs"] = {"separators": SHORT, "allow_nan": False}
    return environment.from_string((files("sweeps.page") / "page.html").read_text("utf8"))


def _shown(part: object) -> object:
    """A part of the page; its markup is escaped."""
    return visible(part) if type(part) is str else part
