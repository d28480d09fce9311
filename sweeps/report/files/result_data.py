"""A result as data for other programs."""

from collections.abc import Iterable, Sequence
from typing import Any

from engine import Verdict
from sweeps.report.files.data_files import plain_number
from sweeps.report.sweep_result import SweepResult


def result_data(result: SweepResult, variants: Iterable[int], names: Sequence[str] = ()) -> dict[str, Any]:
    """A result in JSON types: variants per verdict, and the numbers of some variants.

    Parameters
    ----------
    result : SweepResult
    variants : iterable of int
        Listed variants.
    names : sequence of str
        Summaries (default: all).
    """
    counts = {verdict.name.lower(): count for verdict, count in result.verdict_counts.items()}
    shown = [*result.parameters, *(names or result.summaries)]
    return {
        "title": result.file.title,
        "file": str(result.path),
        "variants": result.file.variants,
        "status": counts,
        "best": result.best(),
        "units": {name: result.units[name] for name in shown},
        "listed": [_variant(result, int(variant), shown) for variant in variants],
    }


def _variant(result: SweepResult, variant: int, names: Sequence[str]) -> dict[str, Any]:
    columns = result.columns
    errors = [name for name in names if f"{name}_error" in columns]
    return {
        "variant": variant,
        "status": Verdict(int(columns["status"][variant])).name.lower(),
        "values": {name: plain_number(columns[name][variant]) for name in names},
        "errors": {name: plain_number(columns[f"{name}_error"][variant]) for name in errors},
    }
