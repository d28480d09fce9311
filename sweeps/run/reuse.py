"""Reuse of earlier result files: same variants of the same machine are not computed twice.

Variants are matched by the bits of their parameters. Other outputs can change the last digits of a summary, because
they change the cuts of the cycle; reused numbers keep their error estimates.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from engine import Verdict
from sweeps.run.blocks import evaluate_variants
from sweeps.store import Column, FileLayout, MappedResult, StoreError, VariantIndex, variant_keys
from sweeps.study.study import Study
from sweeps.study.study_record import machine_record

VERDICT_COLUMNS = ("status", "status_group", "status_at")


class EarlierResult:
    """Reusable content of an earlier result file.

    Parameters
    ----------
    path : Path
        The file, finished or not.
    study : Study
    layout : FileLayout
        Layout of the study's file.

    Attributes
    ----------
    names : frozenset of str
        Available columns; none for another machine, another engine version, or no result.
    """

    def __init__(self, path: Path, study: Study, layout: FileLayout) -> None:
        self.parameters, self.names = study.parameters, frozenset()
        try:
            self._file = MappedResult(path)
            theirs = json.loads(self._file.attributes["study_json"])
            ours = json.loads(layout.attributes["study_json"])
            if not self._file.edited_decisively:
                self.names = _shared(theirs, ours, {*self._file.described} & {*layout.columns})
        except (StoreError, KeyError, ValueError, TypeError, RecursionError):
            # A damaged file isn't reused.
            return

    @cached_property
    def _index(self) -> VariantIndex:
        return VariantIndex(self._file.columns, self.parameters, slice(0, self._file.variants))

    def rows_of(self, values: Mapping[str, np.ndarray], count: int) -> np.ndarray:
        """Its variants with these parameters (count,); −1 if missing or damaged.

        Parameters
        ----------
        values : mapping of str to ndarray (count,)
        count : int
        """
        rows = self._index.variants_of(values, slice(0, count))
        blocks = rows // self._file.block
        for block in np.unique(blocks[rows >= 0]):
            if not (self._file.done[block] and self._file.is_sound(int(block))):
                rows[blocks == block] = -1
        status = self._file.columns["status"][rows]
        rows[(status == Verdict.DROPPED) | (status == Verdict.NOT_COMPUTED)] = -1
        return rows

    def excerpt(self, values: Mapping[str, np.ndarray], drop: np.ndarray) -> "Excerpt":
        """Its excerpt for some variants.

        Parameters
        ----------
        values : mapping of str to ndarray (count,)
            Their parameters.
        drop : ndarray (count,) of bool
            Variants to skip.
        """
        rows = np.where(drop, -1, self.rows_of(values, drop.size))
        there = np.flatnonzero(rows >= 0)
        return Excerpt(there, {name: np.asarray(self._file.columns[name][rows[there]]) for name in sorted(self.names)})

    def is_within(self, study: Study) -> bool:
        """Whether a study's result has all columns and finished variants of the file."""
        if not self.names or not self.names >= {*self._file.flat, *self._file.fields} - {*self.parameters}:
            return False
        size, step = study.design.size, self._file.block
        done = np.repeat(self._file.done, step)[: self._file.variants]
        theirs = variant_keys(self._file.columns, self.parameters, slice(0, self._file.variants))[done]
        parts = ((start, min(start + step, size)) for start in range(0, size, step))
        ours = [variant_keys(study.values(*part)[0], self.parameters, slice(0, part[1] - part[0])) for part in parts]
        return bool(np.isin(theirs, np.concatenate(ours)).all())


def _shared(theirs: Mapping[str, Any], ours: Mapping[str, Any], columns: set[Column]) -> frozenset[str]:
    """Columns of two results that hold the same numbers of the same variants, by their records."""
    if machine_record(theirs) != machine_record(ours):
        return frozenset()
    asked, wanted = theirs["outputs"], ours["outputs"]
    same_summaries = set(asked["summaries"]) == set(wanted["summaries"])
    same_outputs = same_summaries and set(asked["fields"]) == set(wanted["fields"])
    if ours["accuracy"] is not None and not same_outputs:
        # The positions used and the accuracy reached depend on all outputs.
        return frozenset()
    found = {*VERDICT_COLUMNS}
    for name in {*asked["summaries"]} & {*wanted["summaries"]}:
        found |= {name, f"{name}_error"}
    if theirs["field_precision"] == ours["field_precision"]:
        shared = {*asked["fields"]} & {*wanted["fields"]}
        found |= shared | {f"{name}_error" for name in shared}
    by_neighbours = asked["derivatives"] == wanted["derivatives"] and theirs["tolerances"] == ours["tolerances"]
    if by_neighbours and (same_summaries or not ours["tolerances"]):
        of_outputs = {*VERDICT_COLUMNS, *ours["parameters"]}
        outputs = (*wanted["summaries"], *wanted["fields"])
        of_outputs |= {name for output in outputs for name in (output, f"{output}_error")}
        found |= {column.name for column in columns} - of_outputs
    return frozenset(found & {column.name for column in columns})


class Excerpt(NamedTuple):
    """Reusable part of a block.

    Attributes
    ----------
    there : ndarray of int
        Available variants of the block.
    columns : dict of str to ndarray
        Their numbers.
    """

    there: np.ndarray
    columns: dict[str, np.ndarray]

    @property
    def outline(self) -> "Excerpt":
        """Column names and verdicts, which decide what remains to compute."""
        none = np.empty(0)
        return self._replace(columns=dict.fromkeys(self.columns, none) | {"status": self.columns["status"]})


def excerpts_of(earlier: Sequence[EarlierResult], study: Study, variants: slice) -> list[Excerpt]:
    """Excerpts of earlier files for a block, the file with the most columns first.

    Parameters
    ----------
    earlier : sequence of EarlierResult
    study : Study
    variants : slice
    """
    useful = sorted((e for e in earlier if e.names), key=lambda e: -len(e.names))
    if not useful:
        return []
    values, drop = study.values(variants.start, variants.stop)
    return [found for e in useful if (found := e.excerpt(values, drop)).there.size]


class Blocks:
    """Blocks of a study, reusing columns of earlier files.

    Parameters
    ----------
    study : Study
    layout : FileLayout
        Layout of its file; only the columns matter.
    """

    def __init__(self, study: Study, layout: FileLayout) -> None:
        self.study, self.layout = study, layout
        self._parts: dict[tuple[tuple[str, ...], tuple[str, ...]], Study] = {}

    def columns(
        self, variants: slice, excerpts: Sequence[Excerpt] = (), buffer: np.ndarray | None = None
    ) -> dict[str, np.ndarray]:
        """All columns of a block.

        Parameters
        ----------
        variants : slice
        excerpts : sequence of Excerpt
            Reusable parts.
        buffer : ndarray, optional
            Memory for its fields, which the result may use.
        """
        return filled_in(*self.computed(variants, excerpts, buffer), excerpts)

    def computed(
        self, variants: slice, excerpts: Sequence[Excerpt] = (), buffer: np.ndarray | None = None
    ) -> tuple[dict[str, np.ndarray], np.ndarray | None]:
        """Newly computed columns of a block, and which variants are reused.

        Parameters
        ----------
        variants : slice
        excerpts : sequence of Excerpt
            Outlines suffice.
        buffer : ndarray, optional

        Returns
        -------
        columns : dict of str to ndarray
        origin : ndarray (variants,) of int or None
            Excerpt of each reused variant, −1 if computed; None if all are computed.
        """
        values, drop = self.study.values(variants.start, variants.stop)
        if not excerpts:
            return evaluate_variants(self.study, values, drop, buffer), None
        found = {c.name: np.zeros((drop.size, *self.layout.shape(c)[1:]), c.dtype) for c in self.layout.columns}
        found |= values
        origin = np.full(drop.size, -1)
        for k, excerpt in enumerate(excerpts):
            wanted = origin[excerpt.there] < 0
            chosen = excerpt.there[wanted]
            if chosen.size:
                status, some = excerpt.columns["status"][wanted], {name: v[chosen] for name, v in values.items()}
                whole = self._complete(excerpt.columns.keys(), status, some, found, chosen)
                origin[chosen[whole]] = k
        if (left := origin < 0).any():
            some = {name: array[left] for name, array in values.items()}
            for name, array in evaluate_variants(self.study, some, drop[left]).items():
                found[name][left] = array
        return found, origin

    def _complete(
        self,
        taken: Iterable[str],
        status: np.ndarray,
        values: dict[str, np.ndarray],
        found: dict[str, np.ndarray],
        chosen: np.ndarray,
    ) -> np.ndarray:
        """Compute what an earlier file lacks for the variants `chosen`; returns which are complete (chosen,)."""
        whole = np.ones(chosen.size, bool)
        missing = [c.name for c in self.layout.columns if c.name not in taken and c.name not in values]
        if rest := self._asking_for(missing):
            new = evaluate_variants(rest, values, np.zeros(chosen.size, bool))
            # Additional outputs may reveal another failure, which then counts.
            whole = new["status"] == status
            asked = (*rest.summaries, *rest.fields)
            for name in (*asked, *(f"{n}_error" for n in asked)):
                if name in new:
                    found[name][chosen] = new[name]
        by_neighbours = {*missing} & {column.name for column in self.study.sensitivity.columns}
        if by_neighbours:
            new = self.study.sensitivity.of_variants(values, status)
            for name in by_neighbours:
                found[name][chosen] = new[name]
        return whole

    def _asking_for(self, names: Sequence[str]) -> Study | None:
        """The study with only the named outputs; None if there are none."""
        summaries = tuple(name for name in self.study.summaries if name in names)
        fields = tuple(name for name in self.study.fields if {name, f"{name}_error"} & {*names})
        if not summaries and not fields:
            return None
        if (summaries, fields) not in self._parts:
            self._parts[summaries, fields] = replace(
                self.study, summaries=summaries, fields=fields, derivatives=(), tolerances={}
            )
        return self._parts[summaries, fields]


def filled_in(
    columns: dict[str, np.ndarray], origin: np.ndarray | None, excerpts: Sequence[Excerpt]
) -> dict[str, np.ndarray]:
    """Columns of a block with the reused numbers.

    Parameters
    ----------
    columns, origin
        From `Blocks.computed`.
    excerpts : sequence of Excerpt
    """
    if origin is None:
        return columns
    # Arrays from another process may be read-only.
    whole = {name: np.require(array, requirements="W") for name, array in columns.items()}
    for k, excerpt in enumerate(excerpts):
        taken = origin[excerpt.there] == k
        for name, array in excerpt.columns.items():
            whole[name][excerpt.there[taken]] = array[taken]
    return whole
