"""Records of arrays in compiled code: a pointer to a table of their addresses and extents, read where they are used.

As a tuple such a record would be hundreds of arguments, unpacked and passed at every call: a third of the compile time.
"""

import zlib
from collections.abc import Hashable
from functools import cache
from typing import get_type_hints

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import NativeValue, infer_getattr, intrinsic, lower_getattr_generic, models, register_model, unbox
from numba.np.arrayobj import populate_array

from engine.compiling.memory import Memory


class PackedRecord(types.Type):
    """Numba type of a record of arrays, as a pointer to a table of 64-bit words.

    Parameters
    ----------
    record : type of NamedTuple
    fields : tuple of types
        Types of its fields: PackedRecord, Memory, C-ordered arrays, function types, int64 or float64.
    """

    def __init__(self, record: type, fields: tuple[types.Type, ...]) -> None:
        self.record, self.fields = record, fields
        super().__init__(f"{record.__name__}{zlib.crc32(repr(fields).encode()):08x}")

    @property
    def key(self) -> Hashable:
        """What makes two of these types equal."""
        return self.record, self.fields

    @property
    def words(self) -> int:
        """Length of the table."""
        return sum(map(_words, self.fields))

    def kind_of(self, name: str) -> types.Type:
        """Type of a field."""
        return self.fields[self.record._fields.index(name)]

    def place_of(self, name: str) -> tuple[int, types.Type]:
        """First word and type of a field."""
        k = self.record._fields.index(name)
        return sum(map(_words, self.fields[:k])), self.fields[k]


def _words(kind: types.Type) -> int:
    """Number of words for a field: an array has its address and its extents."""
    if isinstance(kind, PackedRecord):
        return kind.words
    return 1 + kind.ndim if isinstance(kind, types.Array) else 1


class Packed:
    """A record of arrays, functions and numbers, for compiled code to read at a pointer.

    Parameters
    ----------
    record : NamedTuple
        Its annotations state which of the arrays are `Memory` in compiled code.

    Attributes
    ----------
    record : as given
    kind : PackedRecord
        Its type in compiled code.
    address : int
        Address of the table.
    """

    def __init__(self, record: tuple) -> None:
        words: list[int] = []
        self.kind = self._numba_type_ = _pack(record, words)
        # The table doesn't keep the arrays alive.
        self.record, self._table = record, np.array(words, np.int64)
        self.address = _address(self._table)


def _address(array: np.ndarray) -> int:
    return array.__array_interface__["data"][0]


_array_type = cache(lambda dtype, ndim: types.Array(from_dtype(dtype), ndim, "C"))
_hints_of, _function_type = cache(get_type_hints), cache(types.FunctionType)
# Types of records, by the identities of their fields' types, each of which is made once; comparing types takes long.
_packed_types: dict[tuple, PackedRecord] = {}


def _packed_type(record: type, fields: tuple[types.Type, ...]) -> PackedRecord:
    key = record, *map(id, fields)
    return _packed_types.get(key) or _packed_types.setdefault(key, PackedRecord(record, fields))


def _pack(value: object, words: list[int], hint: object = None) -> types.Type:
    """Append a value's words to a table; returns its type."""
    if isinstance(value, tuple):
        hints = _hints_of(type(value))
        kinds = [_pack(part, words, hints[name]) for name, part in zip(value._fields, value, strict=True)]
        return _packed_type(type(value), tuple(kinds))
    if isinstance(value, np.ndarray):
        if not value.flags.c_contiguous:
            raise ValueError("arrays of a packed record must be contiguous")
        words.append(_address(value))
        if isinstance(hint, Memory):
            return hint
        words += value.shape
        return _array_type(value.dtype, value.ndim)
    if isinstance(value, types.WrapperAddressProtocol):
        words.append(value.__wrapper_address__())
        return _function_type(value.signature())
    if isinstance(value, float):
        words.append(int(np.float64(value).view(np.int64)))
        return types.float64
    words.append(value)
    return types.int64


@register_model(PackedRecord)
class _PackedModel(models.PrimitiveModel):
    def __init__(self, manager: object, kind: PackedRecord) -> None:
        super().__init__(manager, kind, ir.IntType(64).as_pointer())


@unbox(PackedRecord)
def _unbox(kind: PackedRecord, packed: object, c: object) -> NativeValue:
    held = c.pyapi.object_getattr_string(packed, "address")
    address = c.pyapi.long_as_voidptr(held)
    c.pyapi.decref(held)
    return NativeValue(c.builder.bitcast(address, c.context.get_value_type(kind)))


@infer_getattr
class _GetField(AttributeTemplate):
    key = PackedRecord

    def generic_resolve(self, packed: PackedRecord, name: str) -> types.Type | None:
        return packed.place_of(name)[1] if name in packed.record._fields else None


@lower_getattr_generic(PackedRecord)
def _get_field(context: object, builder: object, packed: PackedRecord, table: object, name: str) -> object:
    place, kind = packed.place_of(name)

    def at(word: int) -> object:
        return builder.gep(table, [context.get_constant(types.intp, place + word)], inbounds=True)

    def read(word: int) -> object:
        found = builder.load(at(word))
        # The table never changes.
        found.set_metadata("invariant.load", builder.module.add_metadata([]))
        return found

    if isinstance(kind, PackedRecord):
        return at(0)
    if isinstance(kind, Memory):
        return builder.inttoptr(read(0), context.get_value_type(kind))
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder)
        shape = [read(1 + k) for k in range(kind.ndim)]
        itemsize = context.get_constant(types.intp, np.dtype(kind.dtype.name).itemsize)
        strides = [itemsize]
        for extent in reversed(shape[1:]):
            strides.insert(0, builder.mul(strides[0], extent, flags=("nsw",)))
        data = builder.inttoptr(read(0), array.data.type)
        populate_array(array, data, shape, strides, itemsize, None)
        return array._getvalue()
    if isinstance(kind, types.FunctionType):
        function = cgutils.create_struct_proxy(kind)(context, builder)
        function.c_addr = builder.inttoptr(read(0), function.c_addr.type)
        return function._getvalue()
    return builder.bitcast(read(0), context.get_value_type(kind))


@intrinsic
def call_at(typing_context: object, address: types.Integer, arguments: types.BaseTuple) -> tuple:
    """Call a compiled function that returns nothing at an address, with a tuple of arguments."""

    def generate(context: object, builder: object, sig: object, args: list) -> object:
        kinds = list(arguments.types)
        kind = context.call_conv.get_function_type(types.none, kinds)
        function = builder.inttoptr(args[0], kind.as_pointer())
        # Numba's functions first take pointers to their result and to an exception.
        unused = [cgutils.alloca_once(builder, pointer.pointee) for pointer in kind.args[:2]]
        given = context.get_arg_packer(kinds).as_arguments(builder, cgutils.unpack_tuple(builder, args[1]))
        builder.call(function, [*unused, *given])
        return context.get_dummy_value()

    return types.none(address, arguments), generate


def _unpacked_type(kind: types.Type) -> types.Type:
    if not isinstance(kind, PackedRecord):
        return kind
    return types.BaseTuple.from_types(tuple(map(_unpacked_type, kind.fields)), pyclass=kind.record)


def _unpack(context: object, builder: object, kind: types.Type, value: object) -> object:
    if not isinstance(kind, PackedRecord):
        return value
    read = [_get_field(context, builder, kind, value, name) for name in kind.record._fields]
    parts = [_unpack(context, builder, *part) for part in zip(kind.fields, read, strict=True)]
    return context.make_tuple(builder, _unpacked_type(kind), parts)


@intrinsic
def unpacked(typing_context: object, packed: PackedRecord) -> tuple:
    """The fields of a packed record as a tuple: a routine then takes for granted that its arrays don't overlap."""

    def generate(context: object, builder: object, sig: object, args: list) -> object:
        return _unpack(context, builder, packed, args[0])

    return _unpacked_type(packed)(packed), generate
