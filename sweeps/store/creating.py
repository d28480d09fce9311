"""Creating a result file: every dataset in its full size, filled with "nothing yet", before any work.

A file that never grows is safe: killing its writer or filling the disk can spoil the rows being written, but not HDF5's
own tables or the rows written earlier.
"""

import errno
import itertools
import json
import os
import shutil
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from .errors import StoreError, explained, is_busy
from .layout import NOT_COMPUTED, Column, FieldAxis, FileLayout, texts_checksums

try:
    import fcntl
except ImportError:
    # Windows locks open files.
    fcntl = None

_VARIANTS_AT_ONCE = 1 << 20
# Timeout and polling interval for a folder's lock, held while a file is created [s].
_PATIENCE, _PAUSE = 5.0, 0.002
# Timeout for a reader's lock, which is short [s].
_READERS_PATIENCE = 1.0
# Column attributes used by readers.
_TOLD = ("long_name", "units", "coordinates", "flag_values", "flag_meanings")
_FINAL_TEXTS = {"finished": 32, "outcome": 2000}


# The default driver without its row buffer.
_UNBUFFERED = "unbuffered"
h5py.register_driver(_UNBUFFERED, lambda access: access.set_sieve_buf_size(0))


def part_path(path: Path) -> Path:
    """Return the name of the unfinished file: `out.part.h5` for `out.h5`."""
    return path.with_name(f"{path.stem}.part{path.suffix}")


def numbered_name(path: Path) -> Path:
    """Return the first unused name `out.1.h5`, `out.2.h5`, … for `out.h5`."""
    names = (path.with_name(f"{path.stem}.{i}{path.suffix}") for i in itertools.count(1))
    return next(name for name in names if not name.exists() and not part_path(name).exists())


def check_space(path: Path, layout: FileLayout) -> None:
    """Raise a `StoreError` with required and free space if the file would not fit.

    Parameters
    ----------
    path : Path
        Planned file; an existing one is replaced.
    layout : FileLayout
        Its shape.
    """
    with explained(path, "check the disk space for"):
        free = shutil.disk_usage(path.absolute().parent).free + (path.stat().st_size if path.exists() else 0)
    if layout.bytes() > free:
        raise StoreError(
            f"{path} needs {bytes_text(layout.bytes())}, {bytes_text(free)} are free on its disk. Request fewer "
            f"variants or fields, store fields as float32, or give another --out."
        )


def create_part(part: Path, layout: FileLayout, sources: Sequence[str]) -> h5py.File:
    """Create the part file, renamed when complete, open and locked.

    Parameters
    ----------
    part : Path
        Its name.
    layout : FileLayout
        Its shape and attributes.
    sources : sequence of str
        Earlier files in the same folder that may hold some of its numbers.

    Returns
    -------
    h5py.File
        As from `unbuffered`.

    Raises
    ------
    StoreError
        Another sweep is using the same file, or a system error.
    """
    raw = part.with_name(f"{part.name}.new")
    with explained(part, "create"):
        with _alone_in(part.parent):
            remove_unlocked(raw)
            try:
                file = h5py.File(raw, "x", driver=_UNBUFFERED)
            except FileExistsError:
                raise StoreError(f"another sweep is creating {part}. Give another --out.") from None
        try:
            # Checked under the draft's lock, so that no file is overwritten.
            if part.exists():
                raise StoreError(f"another sweep is writing {part}. Give another --out.")
            _fill(file, layout, sources)
            file.flush()
            raw.replace(part)
        except BaseException:
            # Still locked: later another process may have its own draft.
            raw.unlink(missing_ok=True)
            file.close()
            raise
    return file


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Context in which no other process creates or removes a draft in a folder.

    A new file isn't locked until HDF5 has opened it: until then, another process would take it for the remains of a
    killed one. Without folder locks this risk remains.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        descriptor = -1
    try:
        if fcntl and descriptor >= 0:
            patience = time.monotonic() + _PATIENCE
            while not _locked(descriptor) and time.monotonic() < patience:
                time.sleep(_PAUSE)
        yield
    finally:
        if descriptor >= 0:
            os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Whether a file is locked now, or can't be."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno != errno.EWOULDBLOCK
    return True


def note_texts(file: h5py.File) -> None:
    """Write the checksums of a file's text attributes and layout."""
    file["progress"].attrs["text_checksums"] = json.dumps(texts_checksums(texts_of(file)))


def texts_of(file: h5py.File) -> dict[str, object]:
    """Text attributes of a file and its columns by name, including the layout."""
    # Views of h5py, `items` and `values`, hold its lock until they end, which an error may keep from other threads.
    columns = {name: column for name in file if isinstance(column := file.get(name), h5py.Dataset)}
    attributes = {name: column.attrs for name, column in columns.items()}
    told = {f"{name}/{key}": own[key] for name, own in attributes.items() for key in _TOLD if key in own}
    codes = {name: " ".join(map(str, found.ravel())) for name, found in told.items() if isinstance(found, np.ndarray)}
    return {**file.attrs, "progress/layout": file["progress"].attrs["layout"], **told, **codes}


def remove_unlocked(path: Path) -> None:
    """Delete a part file that no other process is using, if any.

    Raises
    ------
    StoreError
        Another process holds it.
    """
    if not path.exists():
        return
    check_unlocked(path)
    with explained(path, "delete"):
        # It may have been renamed meanwhile.
        path.unlink(missing_ok=True)


def keep_as(path: Path, kept: Path) -> None:
    """Give a finished file, which another is about to replace, a second name."""
    kept.unlink(missing_ok=True)
    try:
        os.link(path, kept)
    except OSError:
        # A file system without links: for a moment there is no file of the first name.
        path.replace(kept)


def check_unlocked(path: Path) -> None:
    """Raise a `StoreError` if another process is using a file."""
    try:
        unbuffered(path).close()
    except (OSError, RuntimeError) as error:
        # Any other error means a damaged file, which is not in use.
        if is_busy(error):
            raise StoreError(
                f"another sweep is writing {path}: wait, or give another --out. If another program only reads it, it "
                f"should do so without HDF5's locks, by h5py.File(..., locking=False)."
            ) from error


def unbuffered(path: Path) -> h5py.File:
    """Open a file for writing without HDF5's row buffer, after waiting for readers.

    Buffered rows on a full disk would fail repeatedly, at last in h5py's destructors, which can only print.
    """
    patience = time.monotonic() + _READERS_PATIENCE
    while True:
        try:
            return h5py.File(path, "r+", driver=_UNBUFFERED)
        except (OSError, RuntimeError) as error:
            if not is_busy(error) or time.monotonic() > patience:
                raise
        time.sleep(_PAUSE)


def write_final_text(file: h5py.File, name: str, text: str) -> None:
    """Overwrite a preallocated root attribute, `finished` or `outcome`.

    A new attribute would make the file grow and HDF5 rearrange its tables, and a kill just then spoil
    a file whose blocks are all done.
    """
    size = _FINAL_TEXTS[name]
    whole = text.encode()[:size].decode(errors="ignore")
    attribute = h5py.h5a.open(file.id, name.encode())
    attribute.write(np.array(whole.encode(), h5py.string_dtype("utf-8", size)))


def _fill(file: h5py.File, layout: FileLayout, sources: Sequence[str]) -> None:
    scales = {"variant": _variant_scale(file, layout)}
    if layout.over_positions:
        scales["position"] = _axis_scale(file, layout.position)
    scales |= {axis.name: _axis_scale(file, axis) for axis in layout.axes}
    for column in layout.columns:
        dataset = _dataset(file, column.name, layout.shape(column), np.dtype(column.dtype), _nothing(column))
        for axis, name in enumerate(column.dims):
            dataset.dims[axis].attach_scale(scales[name])
        dataset.attrs.update(long_name=column.long_name, units=column.units)
        if layout.coordinates and column.name not in layout.coordinates:
            dataset.attrs["coordinates"] = " ".join(layout.coordinates)
        if column.name == "status":
            _describe_codes(dataset, layout.status_codes)
    file.attrs["Conventions"] = "CF-1.11"
    for name, text in layout.attributes.items():
        file.attrs[name] = text
    for name, size in _FINAL_TEXTS.items():
        file.attrs.create(name, b"", dtype=h5py.string_dtype("utf-8", size))
    # In a separate group: xarray needs all root datasets along the scales.
    progress = file.create_group("progress")
    progress.attrs["layout"] = json.dumps(layout.record())
    progress.attrs["sources"] = json.dumps(list(sources))
    note_texts(file)
    _dataset(progress, "block_done", (layout.blocks,), np.dtype(np.uint8), 0)
    _dataset(progress, "block_checksum", (layout.blocks,), np.dtype(np.uint32), 0)
    if layout.fields:
        _dataset(progress, "fields_checksum", (layout.blocks,), np.dtype(np.uint32), 0)


def _dataset(group: h5py.Group, name: str, shape: tuple[int, ...], dtype: np.dtype, fill: float) -> h5py.Dataset:
    # Filling writes every byte: a full disk fails here and not after hours of work.
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_layout(h5py.h5d.CONTIGUOUS)
    properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    properties.set_fill_time(h5py.h5d.FILL_TIME_ALLOC)
    properties.set_fill_value(np.array(fill, dtype))
    properties.set_obj_track_times(False)
    kind, space = h5py.h5t.py_create(dtype, logical=True), h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(group.id, name.encode(), kind, space, properties))


def _nothing(column: Column) -> float:
    """Return the fill value of unwritten rows, which can't be mistaken for a result."""
    dtype = np.dtype(column.dtype)
    if column.name == "status":
        return NOT_COMPUTED
    if dtype.kind == "f":
        return np.nan
    return np.iinfo(dtype).min if dtype.kind == "i" else np.iinfo(dtype).max


def _variant_scale(file: h5py.File, layout: FileLayout) -> h5py.Dataset:
    scale = _dataset(file, "variant", (layout.variants,), layout.variant_dtype, 0)
    for start in range(0, layout.variants, _VARIANTS_AT_ONCE):
        stop = min(start + _VARIANTS_AT_ONCE, layout.variants)
        scale[start:stop] = np.arange(start, stop, dtype=layout.variant_dtype)
    return _as_scale(scale, "variant", "number of the design variant", "1")


def _axis_scale(file: h5py.File, axis: FieldAxis) -> h5py.Dataset:
    scale = _dataset(file, axis.name, (len(axis.values),), np.dtype(np.float64), np.nan)
    scale[:] = axis.values
    return _as_scale(scale, axis.name, axis.long_name, axis.units)


def _as_scale(dataset: h5py.Dataset, name: str, long_name: str, units: str) -> h5py.Dataset:
    dataset.make_scale(name)
    dataset.attrs.update(long_name=long_name, units=units)
    return dataset


def _describe_codes(dataset: h5py.Dataset, codes: dict[int, str]) -> None:
    meanings = {**codes, NOT_COMPUTED: "not computed"}
    dataset.attrs["flag_values"] = np.array(sorted(meanings), dataset.dtype)
    # CF separates meanings by blanks.
    dataset.attrs["flag_meanings"] = " ".join("_".join(meanings[code].split()) for code in sorted(meanings))


def bytes_text(count: float) -> str:
    """A number of bytes, as a text."""
    for unit, scale in (("GB", 1e9), ("MB", 1e6)):
        if count >= scale:
            return f"{count / scale:.1f} {unit}"
    return f"{count / 1e3:.1f} kB"
