"""Notebook display of scenes, machines, outcomes and studies: a drawing and a table, as HTML."""

import sys
from collections.abc import Iterable, Sequence
from functools import singledispatch
from html import escape
from io import StringIO

import numpy as np

import engine
from sweeps.pictures.drawing import picture
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import house_style
from sweeps.study.study import Study
from sweeps.text.visible import visible

# Longer tables are folded.
SHOWN = 12
# Module and name of the displayed types, which IPython resolves lazily.
_TYPES = (
    ("engine.scene.scene", "Scene"),
    ("engine.machine.machine", "Machine"),
    ("engine.machine.elements.elements_alone", "ElementsAlone"),
    ("engine.machine.results", "Outcome"),
    ("sweeps.study.study", "Study"),
)


def register() -> None:
    """Register HTML display with a running IPython."""
    ipython = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if ipython is not None:
        for module, name in _TYPES:
            ipython.display_formatter.formatters["text/html"].for_type_by_name(module, name, to_html)


@singledispatch
def to_html(thing: object) -> str:
    """A scene, machine, outcome or study as HTML, its mechanism as inline SVG.

    IPython and Jupyter notebooks use it automatically.

    Parameters
    ----------
    thing : Scene, Machine, ElementsAlone, Outcome or Study

    Raises
    ------
    TypeError
        Another type.
    """
    raise TypeError(f"{type(thing).__name__} can't be displayed: give a scene, machine, outcome or study")


@to_html.register
def _(thing: engine.Scene) -> str:
    engine.show_system(thing.units)
    numbers = [
        (path, engine.quantity_text(number.value, engine.described_dimension(number.dimension).unit))
        for path, number in engine.scene_numbers(thing).items()
    ]
    return _page(thing.title or "Scene", _drawing(thing), _folded(f"{len(numbers)} numbers", numbers))


@to_html.register(engine.Machine)
@to_html.register(engine.ElementsAlone)
def _(thing: engine.Machine | engine.ElementsAlone) -> str:
    asked = [("varied", path, "") for path in thing.varied]
    known = {"summary": thing.available_summaries, "field": thing.available_fields}
    asked += [("summary", name, known["summary"][name].long_name) for name in thing.asked_summaries]
    asked += [("field", name, known["field"][name].long_name) for name in thing.asked_fields]
    rest = f"{len(known['summary'])} summaries and {len(known['field'])} fields available"
    return _page(thing.scene.title or "Machine", _drawing(thing.scene), _table(asked), f"<p>{rest}</p>")


@to_html.register
def _(thing: engine.Outcome) -> str:
    codes, counts = np.unique(thing.status, return_counts=True)
    verdicts = ", ".join(f"{n} {engine.Verdict(c).short}" for c, n in zip(codes.tolist(), counts, strict=True))
    rows = [
        (str(i), engine.Verdict(int(thing.status[i])).short, *(_cell(thing, name, i) for name in thing.summaries))
        for i in range(min(thing.status.size, SHOWN))
    ]
    rest = f"the first {SHOWN} of them, " if thing.status.size > SHOWN else ""
    fields = f"<p>fields: {escape(', '.join(thing.fields))}</p>" if thing.fields else ""
    title = f"{engine.counted(thing.status.size, 'variant')}: {verdicts}"
    heads = ("variant", "verdict", *thing.summaries)
    return _page(title, f"<p>{rest}SI units</p>", _table(rows, heads), fields)


@to_html.register
def _(thing: Study) -> str:
    engine.show_system(thing.scene.units)
    rows = []
    for axis in thing.design.axes:
        for name, values in axis.values(np.arange(axis.size)).items():
            ends = (engine.quantity_text(float(value), thing.unit(name)) for value in (values.min(), values.max()))
            rows.append((name, str(axis.size), " … ".join(ends)))
    rows += [(path, "", f"= {expression.text}") for path, expression in thing.derived.items()]
    asked = [("summary", name) for name in thing.summaries] + [("field", name) for name in thing.fields]
    question = f"<p>{escape(thing.question)}</p>" if thing.question else ""
    words = f"{thing.title or thing.name}: {engine.counted(thing.design.size, 'variant')}"
    return _page(
        words, question, _drawing(thing.scene), _table(rows, ("varied", "count", "values")), _folded("asked", asked)
    )


def _cell(outcome: engine.Outcome, name: str, variant: int) -> str:
    value, error = float(outcome.summaries[name][variant]), float(outcome.errors[name][variant])
    return engine.figure_text(value, error, 6) if np.isfinite(value) else "–"


def _drawing(scene: engine.Scene) -> str:
    """The mechanism as inline SVG, or the reason why it can't be drawn."""
    if scene.input is None:
        return f"<p>machine elements: {escape(', '.join(scene.elements))}</p>"
    made = StringIO()
    try:
        figure = picture(scene)
    except PictureError as error:
        return f"<p>{escape(str(error))}</p>"
    for ax in figure.axes:
        ax.set_title("", loc="left")
    with house_style():
        figure.savefig(made, format="svg", metadata={"Date": None})
    # Without XML declaration and document type.
    svg = made.getvalue()
    return f'<div style="max-width:32em">{svg[svg.index("<svg") :]}</div>'


def _page(title: str, *parts: str) -> str:
    return visible(f"<div><p><b>{escape(title)}</b></p>{''.join(parts)}</div>")


def _table(rows: Iterable[Sequence[str]], heads: Sequence[str] = ()) -> str:
    top = "".join(f"<th>{escape(head)}</th>" for head in heads)
    lines = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table>{f'<tr>{top}</tr>' if heads else ''}{lines}</table>" if lines else ""


def _folded(words: str, rows: Sequence[Sequence[str]]) -> str:
    """A table, folded if long."""
    is_open = ' open=""' if len(rows) <= SHOWN else ""
    return f"<details{is_open}><summary>{escape(words)}</summary>{_table(rows)}</details>"
