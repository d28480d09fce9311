"""Reading result files, finished or not."""

import difflib
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from sweeps.text.input_files import HDF5_SIGNATURE

from .creating import part_path
from .errors import StoreError, explained
from .layout import Column

if TYPE_CHECKING:
    import xarray


class Description(NamedTuple):
    """What a result file says about itself.

    Attributes
    ----------
    path : Path
        The file.
    title : str
        Its title, or "".
    attributes : dict
        The root's attributes.
    columns : tuple of Column
        Its columns.
    variants : int
        Number of design variants.
    positions : int
        Number of positions of the fields; 0 without fields.
    position_name, position_units : str
        Name and unit of the coordinate over them; "" without fields.
    blocks, blocks_done : int
        Number of blocks, and of those computed.
    """

    path: Path
    title: str
    attributes: dict[str, Any]
    columns: tuple[Column, ...]
    variants: int
    positions: int
    position_name: str
    position_units: str
    blocks: int
    blocks_done: int


def describe_result(path: Path) -> Description:
    """Return title, attributes, columns and progress of a result file, also while it is written.

    Raises
    ------
    StoreError
        There is no such file or it is no result of a sweep.
    """
    with opened(path) as file:
        record = layout_record(file)
        position = record["position"]
        done = file["progress/block_done"][:]
        # Texts of fixed length come as bytes, unlike the others.
        attributes = {k: v.decode() if isinstance(v, bytes) else v for k, v in file.attrs.items()}
    return Description(
        path=Path(path),
        title=attributes.get("title", ""),
        attributes=attributes,
        columns=tuple(
            Column(name, c["long_name"], c["units"], tuple(c["dims"]), np.dtype(c["dtype"]).type)
            for name, c in record["columns"].items()
        ),
        variants=record["variants"],
        positions=position["count"] if position else 0,
        position_name=position["name"] if position else "",
        position_units=position["units"] if position else "",
        blocks=len(done),
        blocks_done=int(np.count_nonzero(done)),
    )


def read_columns(path: Path, names: Sequence[str] | None = None) -> dict[str, np.ndarray]:
    """Read columns as arrays.

    Parameters
    ----------
    path : Path
        A result file.
    names : sequence of str, optional
        Datasets to read, axes included. Without it, all columns over variants alone: fields, which
        may exceed the memory, are read only when named.

    Raises
    ------
    StoreError
        The file cannot be read or has no such column.
    """
    with opened(path) as file:
        record = layout_record(file)
        if names is None:
            names = [name for name, c in record["columns"].items() if c["dims"] == ["variant"]]
        axes = ["variant", record["position"]["name"]] if record["position"] else ["variant"]
        return {name: _dataset(file, name, [*axes, *record["columns"]])[:] for name in names}


def iterate(path: Path, names: Sequence[str], block: int) -> Iterator[dict[str, np.ndarray]]:
    """Read columns piece by piece, so that memory is bounded by the piece.

    Parameters
    ----------
    path : Path
        A result file.
    names : sequence of str
        Columns to read; `variant` gives the numbers of the variants.
    block : int
        Variants in each piece (the last may have fewer).

    Yields
    ------
    dict
        Array by name, variants along the first axis.

    Raises
    ------
    StoreError
        The file cannot be read or has no such column.
    """
    with opened(path) as file:
        record = layout_record(file)
        datasets = {name: _dataset(file, name, ["variant", *record["columns"]]) for name in names}
        for start in range(0, record["variants"], block):
            yield {name: dataset[start : start + block] for name, dataset in datasets.items()}


def read(path: Path) -> "xarray.Dataset":
    """Open a result file as an `xarray.Dataset`, whose data are read when they are used.

    Raises
    ------
    StoreError
        xarray is not installed or the file cannot be read.
    """
    try:
        import h5netcdf  # noqa: F401  (xarray names a missing engine only in general words)
        import xarray
    except ImportError as error:
        raise StoreError(f"reading {path} as a dataset needs xarray: pip install 'machine-sweeps[xarray]'") from error
    with explained(_existing(path), "read"):
        return xarray.open_dataset(path, engine="h5netcdf")


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open a result file for reading, without a lock.

    The shape of a result file never changes while it is written, so that reading needs no lock,
    and a look at a running sweep's file does not stop the sweep.

    Raises
    ------
    StoreError
        There is no such file or it cannot be read.
    """
    with explained(_existing(path), "read"), _open_unlocked(path) as file:
        yield file


def layout_record(file: h5py.File) -> dict[str, Any]:
    """Return the layout record of an open result file (`FileLayout.record`).

    Raises
    ------
    StoreError
        The file is no result of a sweep.
    """
    if "progress" not in file or "layout" not in file["progress"].attrs:
        raise StoreError(f"{file.filename} is no result of a sweep: it has no record of its layout.")
    return json.loads(file["progress"].attrs["layout"])


def _open_unlocked(path: Path) -> h5py.File:
    try:
        return h5py.File(path, "r", locking=False)
    except OSError:
        pass
    try:
        # HDF5 wants the same answer about locks from all who have a file open in one process.
        return h5py.File(path, "r")
    except OSError as error:
        if not error.errno:
            raise StoreError(f"cannot read {path}: it is damaged or cut off. Run its sweep again.") from error
        raise


def _existing(path: Path) -> Path:
    path = Path(path)
    if path.is_dir():
        raise StoreError(f"cannot read {path}: this is a folder, no result of a sweep.")
    if not path.exists():
        part = part_path(path)
        if part.exists():
            raise StoreError(f"{path} is not finished: run its sweep again to go on, or look at {part}.")
        raise StoreError(f"cannot read {path}: there is no such file. Results are .h5 files, made by `sweeps run`.")
    with explained(path, "read"), path.open("rb") as file:
        start = file.read(len(HDF5_SIGNATURE))
    if start != HDF5_SIGNATURE:
        found = "it is no HDF5 file" if start else "it is empty"
        mend = " Scenes and studies are looked at with `sweeps check`." if path.suffix == ".toml" else ""
        raise StoreError(f"cannot read {path}: {found}, so no result of a sweep.{mend}")
    return path


def _dataset(file: h5py.File, name: str, known: list[str]) -> h5py.Dataset:
    if name in known:
        return file[name]
    close = difflib.get_close_matches(name, known, n=1)
    hint = f"Did you mean {close[0]!r}?" if close else f"It has {', '.join(known)}."
    raise StoreError(f"{file.filename} has no column {name!r}. {hint}")
