"""Points in the unit cube, each computed from its index: random, Latin hypercube, Sobol'.

Every function takes the seed, the number of points, the number of dimensions, and increasing indices
(int64) of the points wanted; it returns float64 of shape (indices, dimensions).
"""

import functools
import math

import numpy as np

SOBOL_BITS = 30
SOBOL_LARGEST = 2**SOBOL_BITS

# Separate streams of random numbers under one seed.
_RANDOM, _JITTER, _PERMUTATION = range(3)
# From ten rounds, permutations are about equally frequent even for the smallest counts.
_FEISTEL_ROUNDS = 10
_SOBOL_CHUNK = 2**15


def random_points(seed: int, count: int, dimensions: int, indices: np.ndarray) -> np.ndarray:
    """Points independent and uniform in [0, 1); `count` has no effect."""
    return _fractions(_philox(seed, _RANDOM, indices, dimensions))


def latin_points(seed: int, count: int, dimensions: int, indices: np.ndarray) -> np.ndarray:
    """Points of a Latin hypercube: in each dimension exactly one in each of `count` equal strata of [0, 1].

    SciPy's Latin hypercube shuffles whole columns, so every worker would have to hold all of it to get at
    one block. Here each column's permutation is a keyed bijection of 0..count-1, computed for the indices
    asked for.
    """
    jitter = _fractions(_philox(seed, _JITTER, indices, dimensions))
    keys = _philox(seed, _PERMUTATION, np.arange(_FEISTEL_ROUNDS), dimensions)
    strata = [permuted(indices, count, column) for column in keys.T]
    return (np.stack(strata, axis=1) + jitter) / count


def sobol_points(seed: int, count: int, dimensions: int, indices: np.ndarray) -> np.ndarray:
    """Points of the scrambled Sobol' sequence that `scipy.stats.qmc.Sobol(dimensions, rng=seed)` draws.

    At most `SOBOL_LARGEST`. A point is a sum modulo 2 over the bits of its index (Antonov and Saleev, 1979),
    so it splits into one term for the upper bits and one for the lower: two tables.
    """
    low, high = _sobol_tables(dimensions, seed, -(-count // _SOBOL_CHUNK))
    digits = low[indices % _SOBOL_CHUNK] ^ high[indices // _SOBOL_CHUNK]
    return digits * 2.0**-SOBOL_BITS


@functools.lru_cache(maxsize=8)
def _sobol_tables(dimensions: int, seed: int, chunks: int) -> tuple[np.ndarray, np.ndarray]:
    """Digits of the first chunk's points, and of each chunk's first point relative to point 0.

    SciPy reaches a point only by stepping through all before it; this way each process does so once.
    """
    # Slow import (0.5 s).
    from scipy.stats import qmc

    engine = qmc.Sobol(dimensions, bits=SOBOL_BITS, rng=seed)
    low = (engine.random(_SOBOL_CHUNK) * SOBOL_LARGEST).astype(np.uint32)
    high = np.zeros((chunks, dimensions), dtype=np.uint32)
    for chunk in range(1, chunks):
        high[chunk] = low[0] ^ (engine.random(1)[0] * SOBOL_LARGEST).astype(np.uint32)
        engine.fast_forward(_SOBOL_CHUNK - 1)
    return low, high


def _philox(seed: int, stream: int, indices: np.ndarray, width: int) -> np.ndarray:
    """Random 64-bit words, shape (len(indices), width), each a function of seed, stream, index and column.

    Philox is a keyed bijection of a counter (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3",
    SC11): the index is the counter's first word, each four columns have their own second word.
    The indices must be increasing; those without gaps are drawn at once.
    """
    runs = np.split(indices, np.flatnonzero(np.diff(indices) != 1) + 1) if len(indices) else []
    words = np.empty((len(indices), -(-width // 4) * 4), dtype=np.uint64)
    key = np.array([seed, stream], dtype=np.uint64)
    for four in range(0, width, 4):
        filled = 0
        for run in runs:
            generator = np.random.Philox(key=key, counter=np.array([run[0], four, 0, 0], dtype=np.uint64))
            block = generator.random_raw(4 * len(run)).reshape(-1, 4)
            words[filled : filled + len(run), four : four + 4] = block
            filled += len(run)
    return words[:, :width]


def _fractions(words: np.ndarray) -> np.ndarray:
    """Uniform numbers in [0, 1) from the upper 53 bits."""
    return (words >> np.uint64(11)) * 2.0**-53


def permuted(indices: np.ndarray, count: int, keys: np.ndarray) -> np.ndarray:
    """Permute 0..count-1 as the keys say, at these indices.

    A Feistel network with modular addition on a grid just larger than `count`, walked on from where it
    leaves 0..count-1 (Black and Rogaway, "Ciphers with arbitrary finite domains", CT-RSA 2002).
    """
    columns = math.isqrt(count - 1) + 1
    rows = -(-count // columns)
    places = indices.astype(np.uint64)
    outside = np.arange(len(places))
    while len(outside):
        row, column = np.divmod(places[outside], np.uint64(columns))
        for key, other in zip(keys[0::2], keys[1::2], strict=True):
            column = (column + _mixed(row ^ key)) % np.uint64(columns)
            row = (row + _mixed(column ^ other)) % np.uint64(rows)
        places[outside] = row * np.uint64(columns) + column
        outside = outside[places[outside] >= count]
    return places.astype(np.int64)


def _mixed(words: np.ndarray) -> np.ndarray:
    """Scramble 64-bit words to 63 bits (the finalizer of SplitMix64, Steele, Lea and Flood, OOPSLA 2014)."""
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    # A wrapped sum would spoil the bijection.
    return (words ^ (words >> np.uint64(31))) >> np.uint64(1)
