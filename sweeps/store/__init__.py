"""HDF5 files of sweep results: written block by block, safe against kills, read by any HDF5 tool."""

from .creating import part_path
from .errors import StoreError
from .layout import NOT_COMPUTED, Column, Layout
from .reading import Description, columns, describe, iterate, read
from .writing import Store

__all__ = [
    "NOT_COMPUTED",
    "Column",
    "Description",
    "Layout",
    "Store",
    "StoreError",
    "columns",
    "describe",
    "iterate",
    "part_path",
    "read",
]
