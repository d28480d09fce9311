"""The store of a running sweep: blocks are written in place and flagged once they are safe."""

import json
import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Self

import h5py
import numpy as np

from sweeps.text.whole_files import refuse_foreign_link, whole_file

from . import creating
from .errors import DamagedError, StoreError, explained
from .layout import DONE, NOT_COMPUTED, Column, FileLayout, checksum
from .reading import MappedResult, damage_text, layout_record, opened

# HDF5's lock doesn't exclude a second store in this process.
_held: set[Path] = set()


class Store:
    """Results of a sweep, written block by block into `NAME.part.h5`, renamed to `NAME.h5` at the end.

    A killed sweep loses only the unfinished blocks: a block is flagged as done after its rows have been passed to the
    operating system. Damage by a power cut shows in the checksums, and such blocks become pending again. Use as a
    context manager.

    The column `status` is written last: concurrent readers that read status first find the numbers of every variant
    that is ok.

    Attributes
    ----------
    path, part : Path
        Final and temporary name.
    layout : FileLayout
        The shape of the file.
    finished : bool
        The final file exists, belongs to this study and is undamaged.
    sources : tuple of Path
        Other or damaged files that may hold some of the study's numbers.
    notes : list of str
        Messages about earlier files.
    """

    def __init__(self, path: Path, layout: FileLayout) -> None:
        self.path, self.part, self.layout = path, creating.part_path(path), layout
        self.finished = False
        self.sources: tuple[Path, ...] = ()
        self.notes: list[str] = []
        self._file: h5py.File | None = None
        self._held_as: Path | None = None
        self._done = np.zeros(layout.blocks, bool)

    @classmethod
    def open(
        cls, path: Path, layout: FileLayout, restart: bool = False, block: Callable[[], int] | None = None
    ) -> Self:
        """Create the part file, or resume an earlier one.

        A part file of another study is renamed to a numbered name.

        Parameters
        ----------
        path : Path
            Final name of the file.
        layout : FileLayout
            Layout and attributes; a resumed file keeps its block size.
        restart : bool
            Discard the part file and ignore a finished file.
        block : callable, optional
            Variants per block instead of the layout's, called only for a new file.

        Returns
        -------
        Store
            With `finished` set if the study's file is complete.

        Raises
        ------
        StoreError
            The existing file isn't a sweep result, another sweep is writing, the disk is too small, or a system error.
        """
        if Path(path).is_dir():
            raise StoreError(f"{path} is a folder. Give a file name as --out.")
        store = cls(Path(path), layout)
        with explained(store.part, "write"):
            refuse_foreign_link(store.part)
        store._hold()
        try:
            if restart:
                creating.check_space(store.part, layout)
                creating.remove_unlocked(store.part)
            if store.part.exists() and store._continue():
                return store
            if not restart and store.path.exists() and store._accept_finished():
                return store
            if block is not None:
                store.layout = replace(layout, block=min(block(), layout.variants))
            creating.check_space(store.part, store.layout)
            store._file = creating.create_part(store.part, store.layout, [source.name for source in store.sources])
            store._done = np.zeros(store.layout.blocks, bool)
        except BaseException:
            store.close()
            raise
        return store

    @property
    def pending(self) -> list[int]:
        """Indices of the unfinished blocks."""
        return [] if self.finished else np.flatnonzero(~self._done).tolist()

    def read(self, i: int) -> dict[str, np.ndarray]:
        """Return the columns of a finished block, including fields.

        Raises
        ------
        StoreError
            System error.
        """
        file, rows = self._file, self.layout.slice(i)
        with explained(self.part, "read"):
            return {c.name: file[c.name][rows] for c in self.layout.columns}

    def write(self, i: int, arrays: Mapping[str, np.ndarray]) -> None:
        """Write a block and flag it as done.

        Parameters
        ----------
        i : int
            Number of the block.
        arrays : mapping
            Array by column name, for all columns, with the block's variants along the first axis.

        Raises
        ------
        StoreError
            System error (disk full, file gone): the block stays pending.
        ValueError
            The arrays don't match the layout.
        """
        rows = self.layout.slice(i)
        arrays = self._checked(rows, arrays)
        file = self._file
        with explained(self.part, "write"):
            for name, values in arrays.items():
                if name != "status":
                    file[name][rows] = values
            # Write order: numbers, then verdicts, then the flag.
            file.flush()
            if "status" in arrays:
                file["status"][rows] = arrays["status"]
                file.flush()
            flat = [arrays[c.name] for c in self.layout.columns if c not in self.layout.fields]
            file["progress/block_checksum"][i] = checksum(i, flat)
            if self.layout.fields:
                file["progress/fields_checksum"][i] = checksum(i, (arrays[c.name] for c in self.layout.fields))
            file["progress/block_done"][i] = DONE
            file.flush()
        self._done[i] = True

    def finish(self, outcome: str = "", keep_former: bool = False) -> None:
        """Give the file its final name, after noting the time (UTC) in its attribute `finished`.

        Parameters
        ----------
        outcome : str
            Text for the root attribute `outcome`, such as counts and duration; cut at 2000 bytes.
        keep_former : bool
            Keep an existing finished file as its previous one, in place of an older one.

        Raises
        ------
        StoreError
            Blocks are pending, or a system error; written blocks stay in the part file.
        """
        if self.finished:
            return
        if self.pending:
            raise StoreError(f"{self.part} cannot be finished: {len(self.pending)} blocks are not done.")
        with explained(self.part, "finish"):
            creating.write_final_text(self._file, "finished", datetime.now(UTC).isoformat(timespec="seconds"))
            creating.write_final_text(self._file, "outcome", outcome)
            self._file.flush()
            with self.part.open("rb+") as plain:
                os.fsync(plain.fileno())
            if keep_former and self.path.exists():
                kept = self.path.with_name(f"{self.path.stem}.previous{self.path.suffix}")
                creating.keep_as(self.path, kept)
                self.notes.append(f"The previous {self.path} is kept as {kept}.")
            # Still locked: otherwise another sweep could remove the part file now.
            self.part.replace(self.path)
        self.finished = True
        self.close()

    def discard(self) -> None:
        """Delete the part file under its lock."""
        with explained(self.part, "delete"):
            self.part.unlink(missing_ok=True)
        self.close()

    def close(self) -> None:
        """Close the file; blocks that are not done stay pending for the next run.

        Raises
        ------
        StoreError
            System error in the last write; flagged blocks are safe.
        """
        if self._held_as:
            _held.discard(self._held_as)
            self._held_as = None
        self._close_file()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _hold(self) -> None:
        part = self.part.resolve()
        if part in _held:
            raise StoreError(f"another sweep is writing {self.part} in this process. Give another --out.")
        _held.add(part)
        self._held_as = part

    def _continue(self) -> bool:
        """Resume the part file if it belongs to this study, else rename it."""
        creating.check_unlocked(self.part)
        try:
            with opened(self.part) as file:
                found = _same_study(file, self.layout)
                names = json.loads(file["progress"].attrs.get("sources", "[]"))
            mapped = MappedResult(self.part)
        except DamagedError:
            self._set_aside("is damaged and can't be resumed")
            return False
        self.sources = tuple(self.path.with_name(name) for name in names)
        if not found or mapped.edited:
            if mapped.done.any():
                self._set_aside("belongs to an earlier version of the study, or to another study")
            else:
                creating.remove_unlocked(self.part)
            return False
        self.layout = replace(self.layout, block=mapped.block)
        with explained(self.part, "continue"):
            self._file = creating.unbuffered(self.part)
            self._done = mapped.done
            if damaged := mapped.damaged():
                self._note_damage(self.part, mapped, damaged)
                self._forget(damaged)
        return True

    def _forget(self, blocks: list[int]) -> None:
        """Make blocks pending again."""
        file = self._file
        for i in blocks:
            file["progress/block_done"][i] = 0
            if "status" in file:
                file["status"][self.layout.slice(i)] = NOT_COMPUTED
        file.flush()
        self._done[blocks] = False

    def _set_aside(self, why: str) -> None:
        aside = creating.part_path(creating.numbered_name(self.path))
        with explained(self.part, "rename"):
            self.part.rename(aside)
        self.sources = (aside, *self.sources)
        self.notes.append(f"The interrupted {self.part} {why}: renamed to {aside}.")

    def _note_damage(self, path: Path, mapped: MappedResult, blocks: list[int]) -> None:
        self.notes.append(f"{path} was damaged: variants {damage_text(mapped, blocks)} are recomputed.")

    def _accept_finished(self) -> bool:
        """Whether the final file is this study's, complete and undamaged."""
        try:
            with opened(self.path) as file:
                found = _same_study(file, self.layout)
            mapped = MappedResult(self.path)
        except DamagedError:
            self.notes.append(f"{self.path} is unreadable: everything is recomputed.")
            return False
        damaged = mapped.damaged()
        if damaged:
            self._note_damage(self.path, mapped, damaged)
        self.finished = found and not damaged and not mapped.edited and bool(mapped.done.all())
        if not self.finished:
            self.sources = tuple(dict.fromkeys((*self.sources, self.path)))
        return self.finished

    def _checked(self, rows: slice, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        names = {c.name for c in self.layout.columns}
        if names != set(arrays):
            raise ValueError(f"columns {sorted(names ^ set(arrays))} are missing or unknown")
        return {c.name: self._checked_array(c, rows, arrays[c.name]) for c in self.layout.columns}

    def _checked_array(self, column: Column, rows: slice, values: np.ndarray) -> np.ndarray:
        values = np.asarray(values)
        expected = (rows.stop - rows.start, *self.layout.shape(column)[1:])
        if values.shape != expected:
            raise ValueError(f"column {column.name}: shape {values.shape}, expected {expected}")
        stored = values.astype(column.dtype, copy=False)
        # HDF5 would clip a code that does not fit.
        if stored.dtype.kind in "iu" and not np.array_equal(stored, values):
            raise ValueError(f"column {column.name}: values do not fit {stored.dtype.name}")
        return stored

    def _close_file(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            with explained(self.part, "close"):
                file.close()


def _same_study(file: h5py.File, layout: FileLayout) -> bool:
    """Whether a file belongs to the study, whatever its block size."""
    theirs, ours = layout_record(file), layout.record()
    same = theirs | {"block": 0} == ours | {"block": 0}
    return same and file.attrs.get("study_hash") == layout.attributes["study_hash"]


def update_texts(path: Path, attributes: Mapping[str, str]) -> None:
    """Update a file's texts if they differ, by replacing it with a modified copy.

    Parameters
    ----------
    path : Path
        A result file, finished or not.
    attributes : mapping of str to str
        Text attributes of its root by name.

    Raises
    ------
    StoreError
        Another sweep is writing the file, or a system error.
    """
    with opened(path) as file:
        changed = {name: text for name, text in attributes.items() if file.attrs.get(name) != text}
    if not changed:
        return
    creating.check_unlocked(path)
    with explained(path, "change"), whole_file(path) as draft:
        shutil.copyfile(path, draft)
        with h5py.File(draft, "r+") as file:
            file.attrs.update(changed)
            creating.note_texts(file)
        with draft.open("rb+") as plain:
            os.fsync(plain.fileno())
