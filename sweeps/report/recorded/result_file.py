"""The content of a result file: columns over variants, the study that made them, and its scene."""

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import engine
from sweeps.report.recorded.recorded_study import recorded_scene, recorded_study
from sweeps.store import FieldAxis, MappedResult
from sweeps.study.study import Study
from sweeps.text.input_files import InputError, check_file
from sweeps.text.scene_text import with_values

# Variants per part in sequential passes.
VARIANTS_AT_A_TIME = 1 << 19
# Variants per part in random access.
CHOSEN_AT_A_TIME = 1 << 14


@dataclass(frozen=True, eq=False)
class ResultFile:
    """The content of a result file; its fields are read on request.

    Attributes
    ----------
    path : Path
    study : Study, optional
        The study of the file, if known.
    """

    path: Path
    study: Study | None = None

    @cached_property
    def file(self) -> MappedResult:
        """The file: its texts, column descriptions and progress."""
        check_file(self.path)
        return MappedResult(self.path)

    @property
    def altered(self) -> list[str]:
        """Warnings on modified texts that numbers don't depend on."""
        self.file.refuse_damage(())
        return [f"{self.path}: {name} was modified" for name in self.file.edited]

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        """All columns over variants, mapped from the file; use `parts` for many variants."""
        return self.file.numbers()

    @cached_property
    def _fields(self) -> dict[str, np.ndarray]:
        self.file.refuse_damage(("fields",))
        return {name: self.file.columns[name] for name in self.fields}

    def parts(self, size: int | None = None) -> Iterator[slice]:
        """Consecutive slices of variants, of a size; the memory of each is released after use."""
        size = size or VARIANTS_AT_A_TIME
        for start in range(0, self.file.variants, size):
            yield slice(start, min(start + size, self.file.variants))
            self.file.release()

    def release(self) -> None:
        """Release memory, as `parts` does."""
        self.file.release()

    @cached_property
    def units(self) -> dict[str, str]:
        """Unit of every column."""
        return {c.name: c.units for c in self.file.described}

    @cached_property
    def long_names(self) -> dict[str, str]:
        """Meaning of every column."""
        return {c.name: c.long_name for c in self.file.described}

    @cached_property
    def record(self) -> dict[str, Any]:
        """The study as data, see `recorded_study`.

        Raises
        ------
        DamagedError
            The file has no matching study.
        """
        return recorded_study(self.file)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the variables."""
        return tuple(self.record["parameters"])

    @property
    def varied(self) -> tuple[str, ...]:
        """Independent variables; the others are derived."""
        return tuple(name for axis in self.record["vary"] for name in axis["names"])

    @property
    def summaries(self) -> tuple[str, ...]:
        """Names of the summaries."""
        return tuple(n for n in self.file.flat if f"{n}_error" in self.units)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields."""
        return tuple(self.file.fields)

    def along(self, field: str) -> FieldAxis:
        """Axis of a field: input positions, or times of a run."""
        self.file.refuse_damage(())
        last = next(c.dims[-1] for c in self.file.described if c.name == field)
        axis = self.file.axes[last]
        words = "input position" if last == "position" else axis["long_name"]
        return FieldAxis(axis["name"], words, axis["units"], self.file.columns[axis["name"]])

    @property
    def accuracy(self) -> float | None:
        """Requested relative accuracy of every summary, if any."""
        return self.record["accuracy"]

    @property
    def done(self) -> int:
        """Number of variants computed or dropped so far."""
        return self.file.variants - self.verdict_counts[engine.Verdict.NOT_COMPUTED]

    @property
    def finished(self) -> str:
        """When the last variant was computed, "2026-11-28 01:49 UTC"; "" if some are missing."""
        text = self.file.attributes.get("finished", "")
        return f"{text[:16].replace('T', ' ')} UTC" if text else ""

    @cached_property
    def verdict_counts(self) -> Counter[engine.Verdict]:
        """Number of variants per verdict."""
        status = self.columns["status"]
        # bincount converts to eight-byte integers.
        there = sum(np.bincount(status[part], minlength=256) for part in self.parts())
        return Counter({verdict: int(there[verdict]) for verdict in engine.Verdict if there[verdict]})

    def first_with(self, verdict: engine.Verdict) -> int | None:
        """Index of the first variant with a verdict, or None."""
        status = self.columns["status"]
        for part in self.parts():
            if (found := status[part] == verdict).any():
                return part.start + int(np.argmax(found))
        return None

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the design's axes, the last fastest; searches have none."""
        if "search" in self.record:
            return (self.file.variants,)
        return tuple(axis["size"] for axis in self.record["vary"]) or (self.file.variants,)

    @property
    def question(self) -> str:
        """The design question of the study."""
        return self.file.attributes.get("question", "")

    @cached_property
    def scene(self) -> engine.Scene:
        """The study's scene, including tables."""
        return recorded_scene(self.record, self.file) if self.study is None else self.study.scene

    @property
    def mechanics(self) -> engine.Mechanics | None:
        """Mechanics of the study's machine, if known."""
        return None if self.study is None else self.study.machine().mechanics

    @cached_property
    def symbols(self) -> dict[str, str]:
        """Textbook symbols of the columns of a mechanism, if known."""
        if self.mechanics is None:
            return {}
        register = self.study.machine().register
        known = {name: register.fields.get(name) or register.summary(name) for name in self.units}
        return {name: quantity.symbol for name, quantity in known.items() if quantity}

    def show_own_units(self) -> None:
        """Display the scene's units, as for `show_units`."""
        engine.show_units(self.record.get("units", {}))

    def variant_values(self, variant: int) -> dict[str, float]:
        """Numbers (SI) of a variant that replace the scene's.

        Raises
        ------
        InputError
            There is no such variant.
        """
        count = self.file.variants
        if not 0 <= variant < count:
            raise InputError.of(str(self.path), f"{variant} is not one of 0 … {count - 1}", key="variant")
        known = engine.scene_numbers(self.scene)
        return {p: float(self.columns[p][variant]) for p in self.parameters if p in known}

    def scene_of(self, variant: int) -> engine.Scene:
        """The scene with the numbers of a variant; errors as for `variant_values` and `with_values`."""
        return with_values(self.scene, self.variant_values(variant))

    def need(self, names: Iterable[str], key: str, known: Iterable[str] = ()) -> None:
        """Reject names that the result doesn't have; the message says how to request those that its machine has.

        Parameters
        ----------
        names : iterable of str
        key : str
            The option that names them.
        known : iterable of str, optional
            Names allowed, if not those of the columns.

        Raises
        ------
        InputError
        """
        known = {*(known or self.columns)}
        for name in (name for name in names if name not in known):
            raise InputError.of(str(self.path), self._absence(name, known), key=key)

    def _absence(self, name: str, known: set[str]) -> str:
        summary = "is not in this result: add it to the summaries of [outputs], and run the study again"
        field = f"is a curve: name one of its numbers, such as {name}.max; as a field of [outputs] it can be exported"
        for words, *asked in ((summary, [name]), (field, [], [name])):
            with suppress(engine.AskError, engine.SceneError):
                engine.made_ready(self.scene, *asked)
                return f"{name!r} {words}"
        return engine.unknown_name_message(name, (other for other in known if not other.endswith("_error")))

    def field_rows(self, name: str, chosen: np.ndarray | slice) -> np.ndarray:
        """Rows of a field (chosen, positions) of some variants, in memory.

        Raises
        ------
        StoreError
            The fields of the file are damaged.
        """
        rows = np.array(self._fields[name][chosen])
        self.file.release()
        return rows

    def taken(self, chosen: np.ndarray | slice) -> dict[str, np.ndarray]:
        """All columns of some variants, in memory."""
        found = {}
        for name, column in self.columns.items():
            found[name] = np.concatenate([np.array(column[piece]) for piece in self._pieces(chosen)])
        return found

    def _pieces(self, chosen: np.ndarray | slice) -> Iterator[np.ndarray | slice]:
        """Some variants in parts; the memory of each is released after use.

        Each access maps at least a page of the file.
        """
        whole = isinstance(chosen, slice)
        for start in range(0, 1 if whole else max(chosen.size, 1), CHOSEN_AT_A_TIME):
            yield chosen if whole else chosen[start : start + CHOSEN_AT_A_TIME]
            self.file.release()

    def rows(self, part: slice | np.ndarray, names: Iterable[str]) -> dict[str, np.ndarray]:
        """Some columns of some variants, and their error estimates where they have any."""
        pairs = (name for wish in names for name in (wish, f"{wish}_error"))
        return {name: self.columns[name][part] for name in pairs if name in self.columns}

    @property
    def lists(self) -> dict[str, int]:
        """Number of entries of each variable that takes its values from a list."""
        axes = self.record["vary"]
        found = {axis["names"][0]: axis["size"] for axis in axes if axis["kind"] == "Listed"}
        return found | {name: len(sizes) for axis in axes for name, sizes in axis.get("sizes", {}).items()}

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Range of each variable: of a search as given, else over all variants."""
        if "search" in self.record:
            return {span["name"]: (span["low"], span["high"]) for span in self.record["search"]["ranges"]}
        found = {name: (np.inf, -np.inf) for name in self.varied if self.lists.get(name, 3) > 2}
        for part in self.parts():
            for name, (low, high) in found.items():
                here = self.columns[name][part]
                found[name] = min(low, float(here.min())), max(high, float(here.max()))
        return found
