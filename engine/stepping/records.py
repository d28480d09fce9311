"""Records of arrays whose last axis counts the variants: subsets of the variants, and results scattered over all."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from engine.cycle.measured import Measured
from engine.words.verdicts import Verdict

Record = TypeVar("Record")


def on_arrays(change: Callable[..., np.ndarray], *records: Record) -> Record:
    """Apply a function to the arrays of records of one type, at any depth; the rest is kept from the first record."""
    first = records[0]
    if isinstance(first, np.ndarray):
        return change(*records)
    if isinstance(first, Measured):
        return Measured(*(change(*parts) for parts in zip(*((m.value, m.error) for m in records), strict=True)))
    if isinstance(first, dict):
        return {key: on_arrays(change, *(record[key] for record in records)) for key in first}
    if isinstance(first, tuple):
        return type(first)(*(on_arrays(change, *parts) for parts in zip(*records, strict=True)))
    return first


def elements_of_counts(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Variant of each element, and the element's number within its variant, from the number of elements of each."""
    variant = np.repeat(np.arange(counts.size), counts)
    return variant, np.arange(variant.size) - np.repeat(np.cumsum(counts) - counts, counts)


def some(record: Record, chosen: np.ndarray) -> Record:
    """A subset of the variants, by index."""
    return on_arrays(lambda row: row[..., chosen], record)


def variant_columns(rows: np.ndarray, who: np.ndarray) -> np.ndarray:
    """Columns of the variants `who`; not a copy where these are all variants in order."""
    return rows if np.array_equal(who, np.arange(rows.shape[-1])) else rows[..., who]


def over_all(record: Record, who: np.ndarray, count: int) -> Record:
    """Results of the variants `who` among all `count` of them; verdicts of the others are OK, their numbers NaN."""

    def spread(row: np.ndarray) -> np.ndarray:
        others, kind = (Verdict.OK, np.uint8) if row.dtype == np.uint8 else (np.nan, float)
        whole = np.full((*row.shape[:-1], count), others, kind)
        whole[..., who] = row
        return whole

    return record if who.size == count else on_arrays(spread, record)


def put(record: Record, who: np.ndarray, others: Record) -> None:
    """Replace the numbers of the variants `who`, in place."""

    def replace(row: np.ndarray, new: np.ndarray) -> np.ndarray:
        row[..., who] = new
        return row

    on_arrays(replace, record, others)
