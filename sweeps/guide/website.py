"""The guide as a site for the browser: the chapters' Markdown, and reference pages, built by Sphinx."""

import re
import shutil
import tomllib
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path

from sweeps.guide.chapters import GUIDE, REFERENCE, SUBJECTS
from sweeps.text.input_files import InputError
from sweeps.text.versions import extra
from sweeps.text.whole_files import scratch_folder


def build_site(reference: Mapping[str, Callable[[], str]], folder: Path) -> Path:
    """Build the site of the guide.

    Parameters
    ----------
    reference : mapping of str to callable
        Makes the Markdown text of each generated page, by name.
    folder : Path
        Folder of the site.

    Returns
    -------
    Path
        Its first page.

    Raises
    ------
    InputError
        Sphinx or its extensions aren't installed, or the site can't be written.
    """
    with extra("guide", "the site", partial(InputError.of, "--web")):
        import furo  # noqa: F401
        import myst_parser  # noqa: F401
        from sphinx.application import Sphinx
        from sphinx.util.docutils import docutils_namespace
    folder = folder.resolve()
    try:
        with scratch_folder() as scratch, docutils_namespace():
            source = scratch / "source"
            _write_source({name: page() for name, page in reference.items()}, source)
            settings = tomllib.loads((GUIDE / "site.toml").read_text("utf8"))
            Sphinx(source, None, folder, scratch / "work", "html", settings, status=None).build()
    except OSError as error:
        raise InputError.of(str(folder), f"can't be written: {error.strerror}") from None
    return folder / "index.html"


def _write_source(reference: Mapping[str, str], source: Path) -> None:
    """Write what Sphinx reads: pages, their pictures and a page of contents."""
    shutil.copytree(GUIDE, source, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    (source / REFERENCE).mkdir()
    for name, text in reference.items():
        (source / REFERENCE / f"{name}.md").write_text(text, "utf8")
    for page in source.rglob("*.md"):
        page.write_text(_for_sphinx(page.read_text("utf8")), "utf8")
    subjects = {**SUBJECTS, REFERENCE: list(reference)}
    contents = "\n".join(_contents(subject, names) for subject, names in subjects.items())
    (source / "index.md").write_text(f"# Guide to machine-sweeps\n\n{contents}", "utf8")


def _contents(subject: str, names: Iterable[str]) -> str:
    pages = "\n".join(f"{subject}/{name}" if subject else name for name in names)
    return f"```{{toctree}}\n:caption: {subject.capitalize() or 'Program'}\n:maxdepth: 1\n\n{pages}\n```\n"


def _for_sphinx(text: str) -> str:
    """A page whose blocks show the name of their file; calculations and formulas get a style."""
    text = re.sub(r"^```(toml|python) (\S+\.\w+)$", r"```{code-block} \1\n:caption: \2\n", text, flags=re.M)
    return re.sub(r"^```(?:calculation|formula)$", "```{code-block} text\n:class: calculation\n", text, flags=re.M)
