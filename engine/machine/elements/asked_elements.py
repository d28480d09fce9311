"""Requested results of a scene's machine elements, for a set of variants with error estimates."""

from collections.abc import Iterable, Sequence
from inspect import getsource

import numpy as np

from engine.compiling.threads import on_all_threads
from engine.elements.element import Answers, Columns, Element
from engine.machine.results import Outcome
from engine.scene.scene import Numbers, Scene
from engine.words.quantity import Quantity
from engine.words.verdicts import Verdict


def element_summaries(scene: Scene) -> list[Quantity]:
    """Summaries of a scene's machine elements."""
    return [
        result._replace(name=f"{name}.{result.name}", long_name=f"{name}: {result.long_name}")
        for name, element in scene.elements.items()
        for result in element.results
    ]


class AskedElements:
    """Requested results of a scene's machine elements.

    Parameters
    ----------
    scene : Scene
    asked : iterable of str
        Names of summaries; those of other parts are ignored.

    Attributes
    ----------
    names : list of str
        Names of the elements' summaries among them.
    elements : dict of str to Element
        Elements with requested summaries.
    """

    def __init__(self, scene: Scene, asked: Iterable[str]) -> None:
        known = {q.name for q in element_summaries(scene)}
        self.names = [name for name in asked if name in known]
        owners = dict.fromkeys(name.partition(".")[0] for name in self.names)
        self.elements = {name: scene.elements[name] for name in owners}

    @property
    def text(self) -> str:
        """Source text of the element classes, with their laws."""
        return "\n\n".join(getsource(kind) for kind in dict.fromkeys(map(type, self.elements.values())))

    def fill(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers, parts: Sequence[str]) -> None:
        """Write the requested results and verdicts of those variants `keep` whose status is OK so far.

        The verdict is that of the law, if it gives one; else the element's verdict on infinite results, such as JAMS;
        NOT_FINITE if a result is NaN.

        Parameters
        ----------
        outcome : Outcome
            Modified in place.
        keep : ndarray of int
            Indices of variants.
        numbers : Numbers
            Numbers of these variants.
        parts : sequence of str
            `Machine.groups`.
        """
        status = outcome.status

        def blame(name: str, fails: np.ndarray, verdict: np.ndarray | Verdict) -> None:
            fails = fails & (status[keep] == Verdict.OK)
            status[keep[fails]] = np.broadcast_to(verdict, fails.shape)[fails]
            outcome.status_group[keep[fails]] = parts.index(f"elements.{name}")

        answers = {
            name: _evaluated(element, numbers.below(f"elements.{name}"), keep.size)
            for name, element in self.elements.items()
        }
        sound = status[keep] == Verdict.OK
        for name, found in answers.items():
            blame(name, found.verdicts != Verdict.OK, found.verdicts)
        for name, found in answers.items():
            element = self.elements[name]
            must = np.array([found.values[r.name] for r in element.results if not r.may_be_undefined])
            blame(name, np.isnan(must).any(axis=0), Verdict.NOT_FINITE)
            blame(name, np.isinf(must).any(axis=0), element.infinite)
        for name in self.names:
            owner, _, result = name.partition(".")
            value, error = answers[owner].values[result], answers[owner].errors[result]
            known = sound & np.isfinite(value)
            outcome.summaries[name][keep] = np.where(known, value, np.nan)
            outcome.errors[name][keep] = np.where(known, error, np.nan)


def _evaluated(element: Element, n: Columns, variants: int) -> Answers:
    """Results of an element, all as arrays (variants,), computed in pieces on all threads."""
    # NumPy's sums and products of a single column differ from those of several by rounding: one variant counts twice.
    columns = max(variants, 2)
    keys, table = list(n), np.array([np.broadcast_to(value, (columns,)) for value in n.values()], float)
    pieces = np.array_split(table, min(-(-columns // element.variants_at_once), columns // 2), axis=1)

    def of(piece: np.ndarray) -> np.ndarray:
        """Values, errors (2, results, variants), with the verdicts as the last row of both."""
        with np.errstate(all="ignore"):
            found = element.evaluate(dict(zip(keys, piece, strict=True)))
        count = piece.shape[1]
        exact = np.zeros(count)
        rows = [
            [np.broadcast_to(found.values[r.name], (count,)) for r in results],
            [exact if r.exact else np.broadcast_to(found.errors[r.name], (count,)) for r in results],
        ]
        verdicts = np.broadcast_to(found.verdicts, (count,)).astype(float)
        return np.array([[*part, verdicts] for part in rows])

    results = element.results
    (*values, verdicts), (*errors, _) = np.concatenate(on_all_threads(of, pieces), axis=-1)[..., :variants]
    names = [r.name for r in results]
    by_name = (dict(zip(names, rows, strict=True)) for rows in (values, errors))
    return Answers(*by_name, verdicts.astype(np.uint8))
