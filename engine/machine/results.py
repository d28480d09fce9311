"""Results of an evaluation, and the memory of its fields."""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from engine.words.glossary import counted
from engine.words.user_error import UserError
from engine.words.verdicts import Verdict

CACHE_LINE = 64


class AskError(UserError, ValueError):
    """A field, summary or setting that a machine can't provide."""


class Outcome(NamedTuple):
    """Results of a set of variants.

    Attributes
    ----------
    status : ndarray (variants,) of uint8
        `Verdict` codes.
    status_group : ndarray (variants,) of int16
        Index of the structural group, element or regime responsible (see `Machine.groups`), −1 if none is.
    status_at : ndarray (variants,)
        Input position of the failure [rad, or m for a sliding input]; NaN without failure.
    summaries, errors : dict of str to ndarray (variants,)
        Requested summaries and their error estimates, SI; also the error estimates of regimes' fields, the maximum over
        their instants.
    fields : dict of str to ndarray (variants, positions)
        Requested fields, SI; for runs, at their instants (see `Machine.kept_at`).
    units : dict of str to str
        SI unit of each summary and field.
    remarks : tuple of str
        Possible mistakes in the values, if no variant works.
    """

    status: np.ndarray
    status_group: np.ndarray
    status_at: np.ndarray
    summaries: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    fields: dict[str, np.ndarray]
    units: Mapping[str, str] = {}
    remarks: tuple[str, ...] = ()

    def with_summaries(self, names: Iterable[str]) -> "Outcome":
        """Copy with these summaries only.

        Parameters
        ----------
        names : iterable of str
        """
        left_out = self.summaries.keys() - set(names)
        if not left_out:
            return self
        kept = ({n: row for n, row in rows.items() if n not in left_out} for rows in (self.summaries, self.errors))
        return self._replace(**dict(zip(("summaries", "errors"), kept, strict=True)))

    def with_names(self, others: Mapping[str, str]) -> "Outcome":
        """Copy with alternative names for some of the quantities.

        Parameters
        ----------
        others : mapping of str to str
            Existing name by alternative name.
        """
        tables = {"summaries": self.summaries, "errors": self.errors, "fields": self.fields, "units": self.units}
        added = {
            key: rows | {n: rows[full] for n, full in others.items() if full in rows} for key, rows in tables.items()
        }
        return self._replace(**added)

    def __repr__(self) -> str:
        codes, counts = np.unique(self.status, return_counts=True)
        words = {code: Verdict(code).short for code in codes}
        verdicts = ", ".join(f"{n} {words[code]}" for code, n in zip(codes, counts, strict=True))
        held = {"summaries": self.summaries, "fields": self.fields}
        asked = "".join(f"; {kind} {self._names_text(names)}" for kind, names in held.items() if names)
        count, remarks = self.status.size, "".join(f"; {remark}" for remark in self.remarks)
        return f"<Outcome of {counted(count, 'variant')}: {verdicts}{remarks}{asked}>"

    def _names_text(self, names: Iterable[str]) -> str:
        """Names with their units."""
        units = {name: self.units.get(name, "1") for name in names}
        return ", ".join(name if unit == "1" else f"{name} [{unit}]" for name, unit in units.items())


def asked_text(machine: object) -> str:
    """Description in one line of a machine or of elements, with the requested quantities."""
    title = f" {machine.scene.title!r}" if machine.scene.title else ""
    asked = {"varied": machine.varied, "summaries": machine.asked_summaries, "fields": machine.asked_fields}
    words = "; ".join(f"{kind} {', '.join(names)}" for kind, names in asked.items() if names)
    return f"<{type(machine).__name__}{title}: {words or 'nothing is requested'}>"


def blank(
    status: np.ndarray, summaries: Iterable[str], fields: dict[str, np.ndarray], with_error: Iterable[str] = ()
) -> Outcome:
    """Outcome of variants of which only the status is known: NaN for every summary, no group responsible.

    `with_error` names the fields that have error estimates.
    """
    names, variants = list(summaries), status.shape[0]
    values = {name: np.full(variants, np.nan) for name in names}
    errors = {name: np.full(variants, np.nan) for name in (*names, *with_error)}
    return Outcome(status, np.full(variants, -1, np.int16), np.full(variants, np.nan), values, errors, fields)


def field_room(shape: tuple[int, int, int], dtype: np.dtype) -> np.ndarray:
    """Allocate fields (fields, variants, positions), aligned to a cache line.

    Vectors that straddle two lines cost time.
    """
    room = np.empty(math.prod(shape) + CACHE_LINE // dtype.itemsize, dtype)
    first = -room.ctypes.data % CACHE_LINE // dtype.itemsize
    return room[first : first + math.prod(shape)].reshape(shape)


def front_of(room: np.ndarray, variants: int) -> np.ndarray:
    """The front of `room` as contiguous fields of fewer variants: kernels are compiled for contiguous arrays."""
    fields, _, positions = room.shape
    return room.reshape(-1)[: fields * variants * positions].reshape(fields, variants, positions)
