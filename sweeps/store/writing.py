"""The store of a sweep that is under way: blocks are written in place and flagged once they are safe."""

import difflib
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Self

import h5py
import numpy as np

from .creating import check_space, create_part, part_path, remove_unlocked, write_final_text
from .errors import RESTART, StoreError, explained
from .layout import Column, FileLayout, differences
from .reading import layout_record, opened

_UNREADABLE = "unreadable"
_TEXTS = ("study", "scene")
_SHOWN_LINES = 12

# HDF5's lock keeps out other processes, but not a second store in this one.
_held: set[Path] = set()


class Store:
    """Results of a sweep, written block by block into `NAME.part.h5`, renamed to `NAME.h5` at the end.

    A killed sweep loses the blocks under way and nothing else: a block is flagged as done only after
    its rows have been handed to the operating system. A power cut is another matter: as nothing forces
    the rows to the disk before the end, start over after one. Use as a context manager.

    Attributes
    ----------
    path, part : Path
        The final name and the one worked under.
    layout : FileLayout
        The shape of the file.
    finished : bool
        The final file exists and is of this study: there is nothing to do.
    """

    def __init__(self, path: Path, layout: FileLayout) -> None:
        self.path, self.part, self.layout = path, part_path(path), layout
        self.finished = False
        self._file: h5py.File | None = None
        self._held_as: Path | None = None
        self._done = np.zeros(layout.blocks, bool)

    @classmethod
    def open(cls, path: Path, layout: FileLayout, restart: bool = False) -> Self:
        """Create the part file, or continue the one that an earlier run of the study left.

        Parameters
        ----------
        path : Path
            Final name of the file.
        layout : FileLayout
            Its shape and attributes; a file found must agree in shape and study hash.
        restart : bool
            Throw away the part file found, and let the new one replace a finished file.

        Returns
        -------
        Store
            With `finished` set if the study's finished file is there already.

        Raises
        ------
        StoreError
            A file of another study is there, another sweep is writing, the disk has too little
            room, or the system refuses.
        """
        if Path(path).is_dir():
            raise StoreError(f"{path} is a folder. Give a file name as --out.")
        store = cls(Path(path), layout)
        store._hold()
        try:
            if restart:
                check_space(store.part, layout, freed=_file_size(store.part))
                remove_unlocked(store.part)
            if store.part.exists():
                store._continue()
            elif not restart and store.path.exists():
                store._accept_finished()
            else:
                check_space(store.part, layout)
                create_part(store.part, layout, _identity(store.path))
                store._continue()
        except BaseException:
            store.close()
            raise
        return store

    @property
    def pending(self) -> list[int]:
        """Numbers of the blocks not done."""
        return [] if self.finished else np.flatnonzero(~self._done).tolist()

    def slice(self, i: int) -> slice:
        """Return the variants of block `i`."""
        return self.layout.slice(i)

    def read(self, i: int) -> dict[str, np.ndarray]:
        """Return the columns of a block that is done, fields too.

        Raises
        ------
        StoreError
            The system refuses.
        """
        file, rows = self._opened(), self.slice(i)
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
            The system refuses (disk full, file gone): the block stays pending, others stay as they are.
        ValueError
            The arrays are not those of the layout.
        """
        rows = self.slice(i)
        arrays = self._checked(rows, arrays)
        file = self._opened()
        with explained(self.part, "write"):
            for name, values in arrays.items():
                file[name][rows] = values
            # The flag must not reach the file before the rows that it vouches for.
            file.flush()
            file["progress/block_done"][i] = 1
            file.flush()
        self._done[i] = True

    def finish(self, outcome: str = "") -> None:
        """Give the file its final name, after noting the time (UTC) in its attribute `finished`.

        Parameters
        ----------
        outcome : str
            Text for the root attribute `outcome`: what is known at the end only, such as counts and
            duration. Cut off at 2000 bytes.

        Raises
        ------
        StoreError
            Blocks are pending or the system refuses; what was written stays in the part file.
        """
        if self.finished:
            return
        if self.pending:
            raise StoreError(f"{self.part} cannot be finished: {len(self.pending)} blocks are not done.")
        file = self._opened()
        with explained(self.part, "finish"):
            write_final_text(file, "finished", datetime.now(UTC).isoformat(timespec="seconds"))
            write_final_text(file, "outcome", outcome)
            file.flush()
        self._close_file()
        with explained(self.part, "finish"):
            with self.part.open("rb+") as plain:
                os.fsync(plain.fileno())
            self.part.replace(self.path)
        self.finished = True
        self.close()

    def close(self) -> None:
        """Close the file; blocks that are not done stay pending for the next run.

        Raises
        ------
        StoreError
            The system refuses to write what is left; blocks flagged as done are safe all the same.
        """
        if self._held_as:
            _held.discard(self._held_as)
            self._held_as = None
        self._close_file()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _hold(self) -> None:
        part = self.part.resolve()
        if part in _held:
            raise StoreError(f"another sweep is writing {self.part} in this process. Give another --out.")
        _held.add(part)
        self._held_as = part

    def _continue(self) -> None:
        with explained(self.part, "continue", f"It is damaged. {RESTART}"):
            self._file = _open_unbuffered(self.part)
            found = _mismatch(self._file, self.layout)
            replaces = self._file["progress"].attrs["replaces"]
            self._done = self._file["progress/block_done"][:].astype(bool)
        if not found and replaces == _identity(self.path):
            return
        self._close_file()
        if self.path.exists():
            self._accept_finished()
        else:
            raise StoreError(f"{self.part} is of another study: {found}\n{RESTART}")

    def _accept_finished(self) -> None:
        with opened(self.path) as file:
            found = _mismatch(file, self.layout, ("block",))
            whole = file["progress/block_done"][:].all()
        if found:
            raise StoreError(f"{self.path} is there already, of another study: {found}\n{RESTART}")
        if not whole:
            raise StoreError(f"{self.path} has blocks not done. Rename it to {self.part} to go on. {RESTART}")
        self.finished = True

    def _opened(self) -> h5py.File:
        if self._file is None:
            raise StoreError(f"{self.part} is not open for writing.")
        return self._file

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
        # HDF5 would clip a code that does not fit, and so make it another code.
        if stored.dtype.kind in "iu" and not np.array_equal(stored, values):
            raise ValueError(f"column {column.name}: values do not fit {stored.dtype.name}")
        return stored

    def _close_file(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            with explained(self.part, "close"):
                file.close()


def _open_unbuffered(part: Path) -> h5py.File:
    """Open for writing so that HDF5 holds no rows back.

    Rows held back on a full disk would fail again and again, last when h5py throws datasets away,
    where it can only print.
    """
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_sieve_buf_size(0)
    return h5py.File(h5py.h5f.open(os.fsencode(part), h5py.h5f.ACC_RDWR, access))


def _mismatch(file: h5py.File, layout: FileLayout, ignored: tuple[str, ...] = ()) -> str:
    """Say what a file and the study at hand differ in; "" when they agree."""
    theirs, ours = layout_record(file), layout.record()
    for key in ignored:
        ours.pop(key)
    found = differences(theirs, ours)
    study_hash = file.attrs.get("study_hash", "absent")
    if study_hash != layout.study_hash:
        found.insert(0, f"study hash {study_hash} in the file, {layout.study_hash} now")
    if not found:
        return ""
    return "; ".join(found) + "." + _text_changes(file, layout)


def _text_changes(file: h5py.File, layout: FileLayout) -> str:
    lines = []
    for name in _TEXTS:
        old, new = file.attrs.get(name, ""), layout.attributes.get(name, "")
        changes = list(difflib.unified_diff(old.splitlines(), new.splitlines(), n=0, lineterm=""))
        lines += [line for line in changes[2:] if not line.startswith("@@")]
    if len(lines) > _SHOWN_LINES:
        lines = [*lines[:_SHOWN_LINES], f"... and {len(lines) - _SHOWN_LINES} more lines"]
    return "".join(f"\n  {line}" for line in lines)


def _identity(path: Path) -> str:
    """Return the study hash of a finished file; "" if there is none."""
    if not path.exists():
        return ""
    try:
        with opened(path) as file:
            return str(file.attrs.get("study_hash", _UNREADABLE))
    except StoreError:
        return _UNREADABLE


def _file_size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0
