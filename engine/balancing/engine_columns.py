"""What is computed of an engine element: forces and couples that shake it, by orders, with its counterweights.

Arrays of the engine's numbers in, arrays of results out, all with variants along their last axis.

The equations are those of `engine.balancing.shaking`. Throws of a layout cancel each other but for rounding; what is
no greater than that counts as balanced. The greatest and the least size of a force or couple of one order are the
half axes of its ellipse: the least is 0 where it swings on a line, and equal to the greatest where it circles.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np

from engine.balancing.engine_element import EngineElement
from engine.balancing.engine_layout import Engine
from engine.balancing.harmonics import crank_masses
from engine.balancing.hodograph import Hodograph
from engine.balancing.shafts import counterweights, remaining
from engine.balancing.shaking import shaking
from engine.element_laws import Law, Result

Numbers = Mapping[str, np.ndarray]
Columns = dict[str, np.ndarray]

# Roundings of a sum over cylinders, relative to the sum of the sizes of its terms: phases up to 6 · 2π, products, sums.
ROUNDED = 64
# An error figure is made of 16 roundings of a result's size.
_SIZE = ROUNDED / 16
EPS = float(np.finfo(float).eps)

_WORDS = {1: "primary", 2: "secondary", 4: "fourth_order", 6: "sixth_order"}
_KEYS = ("stroke", "rod", "piston_mass", "rod_mass", "rod_centre", "throw_mass", "rod_distance", "speed")
_SHARES = ("balanced_rotating", "balanced_reciprocating")
_OPTIONAL = ("bank_angle", "pin_offset", "spacing")


def _results() -> tuple[Result, ...]:
    found = []
    for kind, units, needs in (("force", "N", None), ("couple", "N m", "spacing")):
        for word in _WORDS.values():
            said = word.replace("_", " ")
            found.append(Result(f"{word}_{kind}", f"greatest {said} {kind}", units, needs))
            found.append(Result(f"{word}_{kind}_least", f"least {said} {kind}", units, needs))
        found.append(Result(f"rms_{kind}", f"root mean square of the {kind}, orders 1, 2, 4, 6", units, needs))
    return (*found, Result("crank_unbalance", "unbalance of all counterweights together, each as a size", "kg m"))


_RESULTS = _results()


def engine_law(engine: EngineElement) -> Law:
    """The law of an engine: its numbers in an order of their own, and its results.

    Parameters
    ----------
    engine : EngineElement
    """
    keys = (*_KEYS, *_SHARES, *(key for key in _OPTIONAL if getattr(engine, key) is not None))
    return Law(partial(_rows, engine, keys), lambda element, given: tuple(given(key) for key in keys), _RESULTS)


def engine_columns(engine: EngineElement, numbers: Numbers) -> tuple[Columns, Columns]:
    """All results of an engine for a set of variants.

    Parameters
    ----------
    engine : EngineElement
        Its layout; its numbers are not used.
    numbers : mapping of str to ndarray (variants,)
        Its numbers by their keys.

    Returns
    -------
    columns : dict of str to ndarray (variants,)
        NaN where the crank can't turn.
    sizes : dict of str to ndarray (variants,)
        Of what the cylinders and counterweights contribute to each, whose rounding it carries.
    """
    made = made_engine(engine, numbers)
    weights = counterweights(made, *(numbers[key] for key in _SHARES))
    left = remaining(shaking(made, tuple(_WORDS)), [weights])
    square = np.square(numbers["speed"])
    columns = {"crank_unbalance": np.abs(weights.unbalances).sum(axis=-1)}
    sizes = dict(columns)
    for kind, vector, terms in (
        ("force", left.forces, left.force_terms),
        ("couple", left.couples, left.couple_terms),
    ):
        least = ROUNDED * EPS * terms
        columns[f"rms_{kind}"] = _settled(vector, least).rms * square
        sizes[f"rms_{kind}"] = np.sqrt(np.square(terms).sum(axis=-1)) * square
        for i, word in enumerate(_WORDS.values()):
            for name, axis in ((f"{word}_{kind}", vector.major), (f"{word}_{kind}_least", vector.minor)):
                columns[name] = np.where(axis[..., i] <= least[..., i], 0.0, axis[..., i]) * square
                sizes[name] = terms[..., i] * square
    return columns, sizes


def made_engine(engine: EngineElement, numbers: Numbers) -> Engine:
    """The engine of an element, with the numbers of all variants.

    Parameters
    ----------
    engine, numbers
        As of `engine_columns`.
    """
    n = numbers
    masses = crank_masses(n["piston_mass"], n["rod_mass"], n["rod"], n["rod_centre"], throw=n["throw_mass"])
    sizes = {key: n[key] for key in _OPTIONAL if key in n}
    layout = engine.pattern().layout(**sizes, rod_distance=n["rod_distance"])
    return Engine(layout, n["stroke"] / 2, n["rod"], masses.reciprocating[..., None], masses.rotating[..., None])


def _settled(found: Hodograph, least: np.ndarray) -> Hodograph:
    """Without what is rounding alone."""
    parts = (np.where(np.abs(part) <= least, 0.0, part) for part in (found.forward, found.backward))
    return Hodograph(found.orders, *parts)


def _rows(engine: EngineElement, keys: tuple[str, ...], arguments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Results and the sizes they carry the rounding of (results, variants) from numbers (numbers, variants)."""
    columns, sizes = engine_columns(engine, dict(zip(keys, arguments, strict=True)))
    rows, scales = (np.stack([table[result.name] for result in _RESULTS]) for table in (columns, sizes))
    return rows, scales * _SIZE
