"""What earlier result files hold of a study: numbers of the same variants of the same machine, not computed twice.

A variant is known by the bits of its parameters, wherever it stands in the file. What was asked beside a summary may
change its last digits, as it changes where the cycle is cut: taken-over numbers keep their own error figures.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from engine import Verdict
from sweeps.run.blocks import evaluate_block, evaluate_variants
from sweeps.store import Column, FileLayout, MappedResult, StoreError, describe_result
from sweeps.study.study import Study
from sweeps.study.study_record import machine_record

VERDICT_COLUMNS = ("status", "status_group", "status_at")


class Earlier:
    """What an earlier result file holds of a study.

    Parameters
    ----------
    path : Path
        The file, finished or not.
    study : Study
    layout : FileLayout
        Of the study's own file.

    Attributes
    ----------
    names : frozenset of str
        Columns that it has; none where it is of another machine, another version of the engine, or no result.
    """

    def __init__(self, path: Path, study: Study, layout: FileLayout) -> None:
        self.parameters, self.names = study.parameters, frozenset()
        try:
            described = describe_result(path)
            theirs = json.loads(described.attributes["study_json"])
            self._file = MappedResult(path)
            ours = json.loads(layout.attributes["study_json"])
            if not self._file.edited_decisively and self._file.has_checksums:
                self.names = _shared(theirs, ours, described.columns, layout.columns)
        except (StoreError, KeyError, ValueError, TypeError):
            # Nothing that can be relied on.
            return

    @cached_property
    def _index(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys of all variants, sorted, and which variants they are of."""
        keys = np.concatenate(
            [self._keys(self._file.columns, self._file.rows(block)) for block in range(self._file.done.size)]
        )
        order = np.argsort(keys, kind="stable")
        return keys[order], order

    def _keys(self, columns: Mapping[str, np.ndarray], rows: slice) -> np.ndarray:
        """A 64-bit number for the parameters of each of some variants."""
        found = np.zeros(rows.stop - rows.start, np.uint64)
        for name in self.parameters:
            # Multiplication by an odd number and a shift, as in SplitMix64, spread every bit over all.
            found ^= np.ascontiguousarray(columns[name][rows]).view(np.uint64)
            found = found * np.uint64(0xBF58476D1CE4E5B9) + np.uint64(0x9E3779B97F4A7C15)
            found ^= found >> np.uint64(31)
        return found

    def rows_of(self, values: Mapping[str, np.ndarray], count: int) -> np.ndarray:
        """Which of its variants have these parameters (count,); −1 for those it hasn't, or not undamaged.

        Parameters
        ----------
        values : mapping of str to ndarray (count,)
        count : int
        """
        keys, order = self._index
        wanted = self._keys(values, slice(0, count))
        at = np.minimum(np.searchsorted(keys, wanted), keys.size - 1)
        rows = np.where(keys[at] == wanted, order[at], -1)
        for name in self.parameters:
            rows[self._file.columns[name][rows] != values[name]] = -1
        blocks = rows // self._file.block
        for block in np.unique(blocks[rows >= 0]):
            if not (self._file.done[block] and self._file.is_sound(int(block))):
                rows[blocks == block] = -1
        status = self._file.columns["status"][rows]
        rows[(status == Verdict.DROPPED) | (status == Verdict.NOT_COMPUTED)] = -1
        return rows

    def read(self, name: str, rows: np.ndarray) -> np.ndarray:
        """A column of some variants."""
        return self._file.columns[name][rows]

    def is_within(self, study: Study) -> bool:
        """Whether a study's result has all that the file holds: all its columns, and every variant that is done."""
        if not self.names or not self.names >= {*self._file.flat, *self._file.fields} - {*self.parameters}:
            return False
        size, step = study.design.size, self._file.block
        done = [self._keys(self._file.columns, self._file.rows(i)) for i in np.flatnonzero(self._file.done)]
        parts = ((start, min(start + step, size)) for start in range(0, size, step))
        ours = [self._keys(study.values(*part)[0], slice(0, part[1] - part[0])) for part in parts]
        return not done or bool(np.isin(np.concatenate(done), np.concatenate(ours)).all())


def _shared(
    theirs: Mapping[str, Any],
    ours: Mapping[str, Any],
    their_columns: tuple[Column, ...],
    our_columns: tuple[Column, ...],
) -> frozenset[str]:
    """Columns of two results, told by their records, that hold the same numbers of the same variants."""
    if machine_record(theirs) != machine_record(ours):
        return frozenset()
    asked, wanted = theirs["outputs"], ours["outputs"]
    same_summaries = set(asked["summaries"]) == set(wanted["summaries"])
    same_outputs = same_summaries and set(asked["fields"]) == set(wanted["fields"])
    if ours["accuracy"] is not None and not same_outputs:
        # How many positions are used, and what they reach, is of all outputs together.
        return frozenset()
    found = {*VERDICT_COLUMNS}
    for name in {*asked["summaries"]} & {*wanted["summaries"]}:
        found |= {name, f"{name}_error"}
    if theirs["precision"] == ours["precision"]:
        shared = {*asked["fields"]} & {*wanted["fields"]}
        found |= shared | {f"{name}_error" for name in shared}
    by_neighbours = asked["derivatives"] == wanted["derivatives"] and theirs["tolerances"] == ours["tolerances"]
    if by_neighbours and (same_summaries or not ours["tolerances"]):
        of_outputs = {*VERDICT_COLUMNS, *ours["parameters"]}
        outputs = (*wanted["summaries"], *wanted["fields"])
        of_outputs |= {name for output in outputs for name in (output, f"{output}_error")}
        found |= {column.name for column in our_columns} - of_outputs
    return frozenset(found & {column.name for column in {*their_columns} & {*our_columns}})


class Blocks:
    """Blocks of a study: their columns, taken over as far as earlier files have them.

    Parameters
    ----------
    study : Study
    layout : FileLayout
        Of its file.
    earlier : sequence of Earlier
    """

    def __init__(self, study: Study, layout: FileLayout, earlier: Sequence[Earlier]) -> None:
        self.study, self.layout, self.machine = study, layout, study.machine()
        self.earlier = sorted((e for e in earlier if e.names), key=lambda e: -len(e.names))
        self._buffer = self.machine.new_buffer(layout.block)
        self._parts: dict[tuple[tuple[str, ...], tuple[str, ...]], Study] = {}

    def columns(self, i: int) -> dict[str, np.ndarray]:
        """All columns of block `i`."""
        variants = self.layout.slice(i)
        if not self.earlier:
            return evaluate_block(self.study, self.machine, variants, self._buffer)
        values, drop = self.study.values(variants.start, variants.stop)
        found = {c.name: np.empty((drop.size, *self.layout.shape(c)[1:]), c.dtype) for c in self.layout.columns}
        found |= values
        left = np.ones(drop.size, bool)
        for earlier in self.earlier:
            rows = np.where(left & ~drop, earlier.rows_of(values, drop.size), -1)
            chosen = np.flatnonzero(rows >= 0)
            if chosen.size:
                whole = self._taken(
                    earlier, rows[chosen], {name: v[chosen] for name, v in values.items()}, found, chosen
                )
                left[chosen[whole]] = False
        if left.any():
            some = {name: array[left] for name, array in values.items()}
            for name, array in evaluate_variants(self.study, self.machine, some, drop[left]).items():
                found[name][left] = array
        return found

    def _taken(
        self,
        earlier: Earlier,
        rows: np.ndarray,
        values: dict[str, np.ndarray],
        found: dict[str, np.ndarray],
        chosen: np.ndarray,
    ) -> np.ndarray:
        """Fill in the variants `chosen` from an earlier file; tell which of them are whole by that (chosen,)."""
        for name in earlier.names:
            found[name][chosen] = earlier.read(name, rows)
        status = found["status"][chosen]
        whole = np.ones(chosen.size, bool)
        missing = [c.name for c in self.layout.columns if c.name not in earlier.names and c.name not in values]
        if rest := self._asking_for(missing):
            new = evaluate_variants(rest, rest.machine(), values, np.zeros(chosen.size, bool))
            # What is asked beside may find another fault, which is then the variant's.
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
        """The study with those of its outputs alone that are named; None if none is."""
        summaries = tuple(name for name in self.study.summaries if name in names)
        fields = tuple(name for name in self.study.fields if {name, f"{name}_error"} & {*names})
        if not summaries and not fields:
            return None
        if (summaries, fields) not in self._parts:
            self._parts[summaries, fields] = replace(
                self.study, summaries=summaries, fields=fields, derivatives=(), tolerances={}
            )
        return self._parts[summaries, fields]
