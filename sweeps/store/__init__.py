"""HDF5 files of sweep results: written block by block, safe against kills, read by any HDF5 tool."""

from .creating import bytes_text, part_path
from .errors import DamagedError, StoreError, make_folder_of
from .layout import NOT_COMPUTED, POSITION_NAMES, Column, FieldAxis, FileLayout, columns_of_number
from .reading import MappedResult, VariantIndex, damage_text, open_dataset, read_columns, variant_keys, variants_kept
from .writing import Store, update_texts
