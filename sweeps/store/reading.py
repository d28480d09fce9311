"""Reading result files, finished or not."""

import hashlib
import json
import mmap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from sweeps.text.input_files import HDF5_SIGNATURE
from sweeps.text.versions import extra, origin_text

from .creating import part_path, texts_of
from .errors import DamagedError, StoreError, explained
from .layout import DONE, NOT_COMPUTED, Column, checksum, texts_checksums

if TYPE_CHECKING:
    import xarray


_DECISIVE = ("progress/layout", "study_json")
# Variants compared together.
_NUMBERS_AT_ONCE = 1 << 18
# Damaged blocks named in a message.
_SHOWN = 3
_AGAIN = "Run its study again to recompute the damaged part."
_DAMAGED = "It is damaged or from another program."
_MADE_BY = "Results are .h5 files, made by `sweeps run`."


class MappedResult:
    """A result file, finished or not: its texts, memory-mapped columns, and which of its blocks are intact.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    path : Path
    title : str
        "" if it has none.
    attributes : dict of str to object
        The root's attributes.
    described : tuple of Column
        Names, meanings and units of the columns.
    axes : dict of str to dict
        Axes of fields by dimension, from `FieldAxis.record`.
    columns : dict of str to ndarray
        All columns, and the axes.
    variants, block : int
        Number of variants, in total and per block.
    done : ndarray (blocks,) of bool
        Blocks written at the time of opening.
    flat, fields : list of str
        Names of the columns over variants only (without axes), and of those over another axis.
    edited : list of str
        Modified text attributes and axes.

    Raises
    ------
    StoreError
        There is no such file, or it isn't a sweep result.
    """

    def __init__(self, path: Path) -> None:
        self.path = Path(path)
        with opened(path) as file, explained(path, "read", _DAMAGED, DamagedError):
            record, progress = layout_record(file), file["progress"]
            # Fixed-length texts come as bytes.
            texts = {k: v.decode() if isinstance(v, bytes) else v for k, v in {**file.attrs}.items()}
            self.attributes = {k: _shown_text(v) if isinstance(v, str) else v for k, v in texts.items()}
            self.title = self.attributes.get("title", "")
            self.described = tuple(
                Column(name, c["long_name"], c["units"], tuple(c["dims"]), np.dtype(c["dtype"]).type)
                for name, c in record["columns"].items()
            )
            self.axes = {"position": record["position"]} | {axis["name"]: axis for axis in record.get("axes", ())}
            self.variants, self.block = int(record["variants"]), int(record["block"])
            # Flags are read before the rows, so the rows of flagged blocks are complete.
            # `finished` is read before the flags: in a finished file every block was done by then.
            finished = bool(file.attrs.get("finished"))
            flags = progress["block_done"][:]
            self.done = flags == DONE
            self._misflagged = ~self.done & ((flags != 0) | finished)
            self._sums = {"flat": progress["block_checksum"][:]}
            self.flat = [c.name for c in self.described if c.dims == ("variant",)]
            self.fields = [c.name for c in self.described if len(c.dims) > 1]
            if self.fields:
                self._sums["fields"] = progress["fields_checksum"][:]
            noted, found = json.loads(progress.attrs.get("text_checksums", "{}")), texts_checksums(texts_of(file))
            self.edited = [_shown_text(name) for name, crc in noted.items() if found.get(name) != crc]
            axes = [axis for axis in self.axes.values() if axis]
            names = ("variant", *(axis["name"] for axis in axes), *record["columns"])
            with self.path.open("rb") as raw:
                # Mapped as a whole, so that all pages can be released together.
                self._pages = mmap.mmap(raw.fileno(), 0, access=mmap.ACCESS_READ)
            # Opened once each, which is slow.
            datasets = {name: file[name] for name in names}
            self.columns = {name: _mapped(self._pages, dataset) for name, dataset in datasets.items()}
            datasets |= {f"progress/{name}": progress[name] for name in progress}
            self._refuse_other_shapes(datasets, record)
            if not self._is_numbered():
                self.edited.append("variant")
            for axis in axes:
                values = np.ascontiguousarray(self.columns[axis["name"]], "<f8").tobytes()
                if hashlib.sha256(values).hexdigest() != axis["values (sha256)"]:
                    self.edited.append(axis["name"])
        self._known: dict[tuple[str, int], bool] = {}

    def _refuse_other_shapes(self, datasets: Mapping[str, h5py.Dataset], record: Mapping[str, Any]) -> None:
        """Raise a `DamagedError` if a column has the wrong length or type."""
        position = record["position"]
        sizes = {"variant": self.variants} | {axis["name"]: int(axis["count"]) for axis in record.get("axes", ())}
        sizes |= {"position": int(position["count"]), position["name"]: int(position["count"])} if position else {}
        made = {name: (c["dims"], c["dtype"]) for name, c in record["columns"].items()}
        made |= {name: ([name], "float64") for name in sizes if name not in ("variant", "position")}
        blocks = -(-self.variants // max(self.block, 1))
        shapes = {name: (tuple(sizes[dim] for dim in dims), kind) for name, (dims, kind) in made.items()}
        shapes |= {name: ((blocks,), found.dtype) for name, found in datasets.items() if name.startswith("progress/")}
        for name, (shape, kind) in shapes.items():
            dataset, made_as = datasets[name], h5py.h5t.py_create(np.dtype(kind), logical=True)
            if dataset.shape != shape or dataset.id.get_type() != made_as:
                words = f"{name.removeprefix('progress/')} has the wrong length or type"
                raise DamagedError(f"{self.path} is damaged: {words}. {_AGAIN}")

    def is_sound(self, block: int, kinds: Sequence[str] = ("flat", "fields")) -> bool:
        """Whether a finished block agrees with its checksums.

        Parameters
        ----------
        block : int
        kinds : sequence of {"flat", "fields"}
            Columns over variants only, or fields.
        """
        return all(self._agrees(kind, block) for kind in kinds if kind in self._sums)

    def damaged(self, kinds: Sequence[str] = ("flat", "fields")) -> list[int]:
        """Blocks with modified flags, or finished ones that disagree with their checksums.

        Kinds are as for `is_sound`.
        """
        found = []
        for i in map(int, np.flatnonzero(self.done | self._misflagged)):
            if self._misflagged[i] or not self.is_sound(i, kinds):
                found.append(i)
            self.release()
        return found

    @property
    def edited_decisively(self) -> list[str]:
        """Modified texts that affect the meaning of numbers."""
        return [name for name in self.edited if name in _DECISIVE or name in self.columns]

    def refuse_damage(self, kinds: Sequence[str], texts: bool = False) -> None:
        """Check all finished blocks against their checksums.

        Parameters
        ----------
        kinds : sequence of {"flat", "fields"}
            As for `is_sound`.
        texts : bool
            Check all texts, not only those that numbers depend on.

        Raises
        ------
        DamagedError
            A checksum disagrees.
        """
        if edited := self.edited if texts else self.edited_decisively:
            raise DamagedError(f"{self.path} is damaged: {edited[0]} was modified. {_AGAIN}")
        if damaged := self.damaged(kinds):
            words = damage_text(self, damaged)
            raise DamagedError(f"{self.path} is damaged (variants {words}). {_AGAIN}")

    def numbers(self) -> dict[str, np.ndarray]:
        """The columns over variants, after checking their checksums; verdicts as from `known_status`.

        Raises
        ------
        DamagedError
            A checksum disagrees.
        """
        status = self.known_status()
        self.refuse_damage(("flat",))
        return {name: self.columns[name] for name in self.flat} | {"status": status}

    def known_status(self) -> np.ndarray:
        """The column `status`; for an unfinished file a copy with pending blocks as not computed.

        Status is written last, so variants that are ok have their numbers.
        """
        status = self.columns["status"]
        if self.done.all():
            return status
        status = np.array(status)
        for i in map(int, np.flatnonzero(~self.done)):
            status[self.rows(i)] = NOT_COMPUTED
        return status

    def rows(self, block: int) -> slice:
        """Variants of a block."""
        return slice(block * self.block, min((block + 1) * self.block, self.variants))

    def release(self) -> None:
        """Release memory; data are read again on access."""
        if hasattr(mmap, "MADV_DONTNEED"):
            self._pages.madvise(mmap.MADV_DONTNEED)

    def _is_numbered(self) -> bool:
        """Whether the variant axis counts from 0; checked in parts to bound memory."""
        numbers = self.columns["variant"]
        if numbers.shape != (self.variants,):
            return False
        for start in range(0, self.variants, _NUMBERS_AT_ONCE):
            part = numbers[start : start + _NUMBERS_AT_ONCE]
            if not np.array_equal(part, np.arange(start, start + part.size)):
                return False
            self.release()
        return True

    def _agrees(self, kind: str, block: int) -> bool:
        if (kind, block) not in self._known:
            rows = self.rows(block)
            found = checksum(block, (self.columns[name][rows] for name in getattr(self, kind)))
            self._known[kind, block] = found == int(self._sums[kind][block])
        return self._known[kind, block]


def _mapped(pages: mmap.mmap, dataset: h5py.Dataset) -> np.ndarray:
    offset = dataset.id.get_offset()
    if offset is None:
        # Packed by another program.
        return dataset[:]
    return np.frombuffer(pages, dataset.dtype, dataset.size, offset).reshape(dataset.shape)


def variant_keys(columns: Mapping[str, np.ndarray], names: Iterable[str], rows: slice) -> np.ndarray:
    """A 64-bit hash of each variant's parameters.

    Parameters
    ----------
    columns : mapping of str to ndarray
    names : iterable of str
        The parameters.
    rows : slice
        Which variants.
    """
    found = np.zeros(rows.stop - rows.start, np.uint64)
    for name in names:
        # Adding 0 turns −0 into 0. Odd multiplication and shift mix the bits, as in SplitMix64.
        found ^= (columns[name][rows] + 0.0).view(np.uint64)
        found = found * np.uint64(0xBF58476D1CE4E5B9) + np.uint64(0x9E3779B97F4A7C15)
        found ^= found >> np.uint64(31)
    return found


class VariantIndex:
    """Variants of a result file, found by their parameters.

    Parameters
    ----------
    columns : mapping of str to ndarray
        The file's.
    names : sequence of str
        The parameters.
    rows : slice
        Which variants.
    """

    def __init__(self, columns: Mapping[str, np.ndarray], names: Sequence[str], rows: slice) -> None:
        self.columns, self.names = columns, names
        keys = variant_keys(columns, names, rows)
        order = np.argsort(keys, kind="stable")
        self._keys, self._variants = keys[order], rows.start + order

    def variants_of(self, columns: Mapping[str, np.ndarray], rows: slice) -> np.ndarray:
        """Variants with the parameters of some others (rows,); −1 where there is none.

        Parameters
        ----------
        columns : mapping of str to ndarray
            Those of the others.
        rows : slice
        """
        wanted = variant_keys(columns, self.names, rows)
        at = np.minimum(np.searchsorted(self._keys, wanted), self._keys.size - 1)
        found = np.where(self._keys[at] == wanted, self._variants[at], -1)
        for name in self.names:
            found[self.columns[name][found] != columns[name][rows]] = -1
        return found


def damage_text(result: MappedResult, blocks: Sequence[int]) -> str:
    """Name the variants of some blocks, "0 … 4095, 8192 … 12287", limited to the first few."""
    shown = [result.rows(i) for i in blocks[:_SHOWN]]
    words = ", ".join(f"{r.start} … {r.stop - 1}" if r.stop - r.start > 1 else f"{r.start}" for r in shown)
    return words + (f" and {len(blocks) - _SHOWN} more blocks" if len(blocks) > _SHOWN else "")


def variants_kept(path: Path) -> int:
    """Number of variants kept under a result file's name: the most of the finished and unfinished file and its sources.

    Parameters
    ----------
    path : Path
        The final name.
    """
    found, names = [0], [part_path(path).name, path.name]
    with suppress(StoreError), opened(part_path(path)) as file:
        names += json.loads(file["progress"].attrs.get("sources", "[]"))
    for name in names:
        with suppress(StoreError):
            mapped = MappedResult(path.with_name(name))
            found.append(min(int(mapped.done.sum()) * mapped.block, mapped.variants))
    return max(found)


def read_columns(path: Path, names: Sequence[str] | None = None) -> dict[str, np.ndarray]:
    """Read columns as arrays after checking their checksums.

    Parameters
    ----------
    path : Path
        A result file.
    names : sequence of str, optional
        Datasets to read, including axes; default: all columns over variants. Fields, which may exceed the memory, are
        read only when named.

    Raises
    ------
    StoreError
        The file cannot be read, or is damaged.
    """
    mapped = MappedResult(path)
    names = mapped.flat if names is None else names
    mapped.refuse_damage(("flat", "fields") if {*names} & {*mapped.fields} else ("flat",))
    first = {"status": np.array(mapped.known_status())} if "status" in names else {}
    return {name: first[name] if name in first else np.array(mapped.columns[name]) for name in names}


def open_dataset(path: Path, check: bool = True) -> "xarray.Dataset":
    """Open a result file as a lazy `xarray.Dataset`.

    Parameters
    ----------
    path : Path
    check : bool
        Check all checksums first, including fields and texts.

    Raises
    ------
    StoreError
        xarray is not installed, or the file cannot be read or is damaged.
    """
    with extra("xarray", f"reading {path} as a dataset", StoreError):
        import h5netcdf  # noqa: F401  (clearer than xarray's message on a missing engine)
        import xarray
    if check:
        MappedResult(Path(path)).refuse_damage(("flat", "fields"), texts=True)
    with explained(_existing(path), "read"):
        try:
            return xarray.open_dataset(path, engine="h5netcdf")
        except OSError:
            # A running sweep locks the file.
            return xarray.open_dataset(path, engine="h5netcdf", driver_kwds={"locking": False})


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open a result file for reading, without a lock.

    A result file's layout never changes during writing, so reading needs no lock and does not disturb a running sweep.

    Raises
    ------
    StoreError
        There is no such file or it cannot be read.
    """
    with explained(_existing(path), "read"), _open_unlocked(path) as file:
        yield file


def _shown_text(text: str) -> str:
    """A printable text, as damaged ones may not be Unicode."""
    return text.encode(errors="replace").decode()


def layout_record(file: h5py.File) -> dict[str, Any]:
    """Return the layout record of an open result file (`FileLayout.record`).

    Raises
    ------
    StoreError
        The file isn't a sweep result.
    """
    if "progress" not in file or "layout" not in file["progress"].attrs:
        raise StoreError(f"{file.filename} is not a sweep result: it has no layout record. {_MADE_BY}")
    with explained(Path(file.filename), "read", _DAMAGED, DamagedError):
        record = json.loads(_shown_text(file["progress"].attrs["layout"]))
    if not isinstance(record, dict) or not {"variants", "block", "position", "columns"} <= record.keys():
        maker = origin_text(str(file.attrs.get("versions", "")))
        raise DamagedError(f"cannot read {file.filename}: it is damaged, or {maker}")
    return record


def _open_unlocked(path: Path) -> h5py.File:
    try:
        return h5py.File(path, "r", locking=False)
    except OSError:
        pass
    try:
        # HDF5 requires one locking mode per file in a process.
        return h5py.File(path, "r")
    except OSError as error:
        if not error.errno:
            raise DamagedError(f"cannot read {path}: it is damaged or truncated. Run its study again.") from error
        raise


def _there_is(results: Iterable[Path]) -> str:
    near = [str(other) for other in sorted(results)]
    return f"There is {' and '.join(near)}." if near else _MADE_BY


def _existing(path: Path) -> Path:
    path = Path(path)
    if path.is_dir():
        raise StoreError(f"cannot read {path}: this is a folder, not a sweep result. {_there_is(path.glob('*.h5'))}")
    if not path.exists():
        part = part_path(path)
        if part.exists():
            raise StoreError(f"{path} is not finished: run its sweep again to resume, or see {part}.")
        raise StoreError(
            f"cannot read {path}: there is no such file. {_there_is(path.parent.glob(f'{path.stem}*.h5'))}"
        )
    if not path.is_file():
        # Opening a pipe would block.
        raise StoreError(f"cannot read {path}: it is a device or a pipe, not a sweep result.")
    with explained(path, "read"), path.open("rb") as file:
        start = file.read(len(HDF5_SIGNATURE))
    if start != HDF5_SIGNATURE:
        found = "it is not an HDF5 file" if start else "it is empty"
        mend = f"`sweeps run {path}` computes its numbers, into a result file." if path.suffix == ".toml" else _MADE_BY
        raise StoreError(f"cannot read {path}: {found}, so not a sweep result. {mend}")
    return path
