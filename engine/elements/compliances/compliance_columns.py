"""What is computed of the parts of a drive: their stiffness and damping as one shaft feels them, and their shares."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from engine.elements.compliances.elastic_parts import ComplianceElement
from engine.elements.compliances.reduction import (
    damping_and_absorption,
    in_series,
    leaf_paths,
    part_keys,
    reduced_part,
)
from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges


def compliance_law(element: ComplianceElement) -> LawOfArrays:
    """The law of the parts of a drive: their numbers in an order of their own, and results, which depend on the parts.

    Parameters
    ----------
    element : ComplianceElement
    """
    keys, results = tuple(_keys(element)), tuple(_results(element))
    return LawOfArrays(
        with_nudges(partial(_rows, element, keys, tuple(r.name for r in results))),
        lambda given_element, given: tuple(given(key) for key in keys),
        results,
    )


def _keys(element: ComplianceElement) -> Iterator[str]:
    for name, part in element.parts.items():
        yield from part_keys(part, f"parts.{name}")
    yield from (key for key in ("moment", "frequency") if getattr(element, key) is not None)


def _results(element: ComplianceElement) -> Iterator[ElementResult]:
    yield ElementResult("stiffness", "torsional stiffness of all parts, reduced", "N m rad-1")
    yield ElementResult("compliance", "torsional compliance of all parts, reduced", "rad N-1 m-1")
    yield ElementResult("energy_absorption", "energy absorption of all parts", "1")
    if element.frequency is not None:
        yield ElementResult("damping", "torsional damping of all parts, reduced", "N m s rad-1")
    if element.moment is not None:
        yield ElementResult("twist", "twist of all parts under the moment, reduced", "rad")
    for path in leaf_paths(element.parts):
        yield ElementResult(f"{path}.stiffness", f"stiffness of {path} about its own axis", "N m rad-1")
        yield ElementResult(f"{path}.share", f"share of {path} in the energy, in series that in the compliance", "1")
        if element.moment is not None:
            yield ElementResult(f"{path}.moment", f"moment of {path} about its own axis", "N m")
            yield ElementResult(f"{path}.twist", f"twist of {path} about its own axis", "rad")


def _rows(element: ComplianceElement, keys: tuple[str, ...], names: tuple[str, ...], table: np.ndarray) -> np.ndarray:
    n = dict(zip(keys, table, strict=True))
    whole = in_series({name: reduced_part(part, n, f"parts.{name}") for name, part in element.parts.items()})
    columns = {
        "stiffness": whole.stiffness,
        "compliance": 1.0 / whole.stiffness,
        "energy_absorption": whole.absorption,
    }
    if element.frequency is not None:
        columns["damping"], columns["energy_absorption"] = damping_and_absorption(whole, n["frequency"])
    for path, share in whole.within.items():
        columns |= {f"{path}.stiffness": share.stiffness, f"{path}.share": share.energy}
        if element.moment is not None:
            columns[f"{path}.moment"] = n["moment"] * share.moment
            columns[f"{path}.twist"] = n["moment"] / whole.stiffness * share.twist
    if element.moment is not None:
        columns["twist"] = n["moment"] / whole.stiffness
    return np.stack([np.broadcast_to(columns[name], table.shape[1:]) for name in names])
