"""Layout of a result file: columns, axes and blocks, with the checksums of blocks and texts."""

import hashlib
import math
import struct
import zlib
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .errors import StoreError

NOT_COMPUTED = 255
"""Status code of a variant whose block has not been written yet."""

DONE = 1
"""Flag of a block that is written; 0 before."""

# Names of the position axis: crank angle, or fraction of a sliding input's range.
POSITION_NAMES = ("phi", "travel")
RESERVED = ("variant", "progress")
# HDF5 takes a page for the headers and heap of each dataset; one more covers the groups.
_PAGE = 4096
# Written at the end, in place.
CHANGING = ("finished", "outcome")


def checksum(block: int, arrays: Iterable[np.ndarray]) -> int:
    """CRC-32 of a block's arrays in sequence; it depends on the block number.

    Parameters
    ----------
    block : int
        Number of the block.
    arrays : iterable of ndarray
    """
    crc = zlib.crc32(struct.pack("<q", block))
    for array in arrays:
        crc = zlib.crc32(np.ascontiguousarray(array), crc)
    return crc


def texts_checksums(texts: Mapping[str, object]) -> dict[str, int]:
    """CRC-32 of each constant text attribute by name.

    Parameters
    ----------
    texts : mapping of str to object
    """
    kept = {name: text for name, text in texts.items() if isinstance(text, str) and name not in CHANGING}
    return {name: zlib.crc32(text.encode(errors="surrogatepass")) for name, text in kept.items()}


class Column(NamedTuple):
    """One dataset of a result file.

    Attributes
    ----------
    name : str
        Dataset name, without blanks and slashes.
    long_name : str
        Long name.
    units : str
        CF (UDUNITS) units: "kg m2", "N m", "rad s-1", "1".
    dims : tuple of str
        ("variant",), or ("variant", "position") for a field, or with another axis.
    dtype : type
        A numpy float or integer type.
    """

    name: str
    long_name: str
    units: str
    dims: tuple[str, ...] = ("variant",)
    dtype: Any = np.float64

    def record(self) -> dict[str, Any]:
        """Identity of the column for resuming, without its name."""
        about = {"long_name": self.long_name, "units": self.units}
        return about | {"dims": list(self.dims), "dtype": np.dtype(self.dtype).name}


def columns_of_number(name: str, long_name: str, units: str) -> list[Column]:
    """The columns of a number of each variant and of its error estimate."""
    return [Column(name, long_name, units), Column(f"{name}_error", f"error estimate of: {long_name}", units)]


class FieldAxis(NamedTuple):
    """Axis of fields (input positions or times of a run): name, meaning, units and values."""

    name: str
    long_name: str
    units: str
    values: np.ndarray

    @property
    def over_positions(self) -> bool:
        """Whether it holds positions of the input."""
        return self.name in POSITION_NAMES

    def record(self) -> dict[str, Any]:
        """Identity of the axis for resuming."""
        values = np.ascontiguousarray(self.values, dtype="<f8")
        about = {"name": self.name, "long_name": self.long_name, "units": self.units, "count": len(values)}
        return about | {"values (sha256)": hashlib.sha256(values.tobytes()).hexdigest()}


@dataclass(frozen=True, eq=False)
class FileLayout:
    """The fixed shape of a result file.

    Attributes
    ----------
    variants : int
        Number of design variants.
    block : int
        Variants per block, the unit that is written and flagged as done.
    columns : tuple of Column
        The datasets.
    attributes : dict
        Text attributes of the root. `study_hash` is required: it names the study.
    coordinates : tuple of str
        Parameter columns, which xarray makes coordinates.
    status_codes : dict
        Meaning of each code in the column `status`. 255 is reserved for "not computed".
    position : FieldAxis, optional
        Positions of the input; required for fields over them.
    axes : tuple of FieldAxis
        Other axes of fields.

    Raises
    ------
    StoreError
        A parameter has the name of another column or of an axis.
    """

    variants: int
    block: int
    columns: tuple[Column, ...]
    attributes: dict[str, str]
    coordinates: tuple[str, ...] = ()
    status_codes: dict[int, str] = field(default_factory=dict)
    position: FieldAxis | None = None
    axes: tuple[FieldAxis, ...] = ()

    def __post_init__(self) -> None:
        names = [*RESERVED, *([self.position.name] if self.over_positions else [])]
        names += [axis.name for axis in self.axes] + [c.name for c in self.columns]
        doubled = [name for name, count in Counter(names).items() if count > 1]
        if doubled:
            raise StoreError(f"result files have other columns named {', '.join(doubled)}: rename these parameters.")

    @property
    def fields(self) -> tuple[Column, ...]:
        """The columns over variants and positions, or another axis."""
        return tuple(c for c in self.columns if len(c.dims) > 1)

    @property
    def over_positions(self) -> bool:
        """Whether there are fields over positions."""
        return any("position" in c.dims for c in self.columns)

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return -(-self.variants // self.block)

    def slice(self, i: int) -> slice:
        """Return the variants of block `i`."""
        return slice(i * self.block, min((i + 1) * self.block, self.variants))

    def shape(self, column: Column) -> tuple[int, ...]:
        """Return the shape of a column's dataset."""
        sizes = {"position": self.position, **{axis.name: axis for axis in self.axes}}
        return self.variants, *(len(sizes[dim].values) for dim in column.dims[1:])

    @property
    def variant_dtype(self) -> np.dtype:
        """Type of the variant numbers: four bytes if sufficient."""
        return np.dtype(np.int32 if self.variants <= np.iinfo(np.int32).max else np.int64)

    def bytes(self) -> int:
        """Return an upper bound on the size of the file."""
        data = sum(math.prod(self.shape(c)) * np.dtype(c.dtype).itemsize for c in self.columns)
        positions = len(self.position.values) if self.over_positions else 0
        axes = self.variants * self.variant_dtype.itemsize + 8 * positions
        axes += sum(8 * len(axis.values) + _PAGE for axis in self.axes)
        text = sum(len(f"{key}{value}".encode()) for key, value in self.attributes.items())
        return data + axes + 9 * self.blocks + text + (len(self.columns) + 18) * _PAGE

    def record(self) -> dict[str, Any]:
        """Return the identity of the layout for resuming, in JSON types."""
        # Files without other axes keep the older format.
        axes = {"axes": [axis.record() for axis in self.axes]} if self.axes else {}
        return axes | {
            "variants": self.variants,
            "block": self.block,
            "position": self.position.record() if self.over_positions else None,
            "columns": {c.name: c.record() for c in self.columns},
            "coordinates": list(self.coordinates),
            "status codes": {str(code): meaning for code, meaning in sorted(self.status_codes.items())},
        }
