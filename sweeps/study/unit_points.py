"""Points in the unit cube, each computed from its index: random, Latin hypercube, Sobol'.

Every function takes the seed, the number of points, the number of dimensions, and increasing indices
(int64) of the points wanted; it returns float64 of shape (indices, dimensions).
"""

import functools
import math
import operator
from pathlib import Path

import numpy as np
import scipy

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

    `scipy.stats.qmc` draws the same points, but only in order, and takes half a second to import.
    """
    shift, directions = _scrambled(seed, _directions(dimensions))
    low, high = (np.zeros((1, dimensions), np.uint32) for _ in range(2))
    # In the order of the Gray code, the second half of a table is the first one backwards, in another half of the cube.
    for bit in range(SOBOL_BITS):
        if bit < _SOBOL_CHUNK.bit_length() - 1:
            low = np.concatenate([low, low[::-1] ^ directions[bit]])
        elif len(high) < chunks:
            high = np.concatenate([high, high[::-1] ^ directions[bit]])
    # Each chunk but the first begins with the lower bits of a Gray code whose next higher bit is set.
    high[1::2] ^= directions[_SOBOL_CHUNK.bit_length() - 2]
    return low ^ shift, high


def _directions(dimensions: int) -> np.ndarray:
    """Direction numbers (bits, dimensions) of Joe and Kuo (2008)."""
    with np.load(Path(scipy.__file__).with_name("stats") / "_sobol_direction_numbers.npz") as known:
        polynomials, starts = known["poly"][:dimensions], known["vinit"][:dimensions]
    numbers = np.ones((SOBOL_BITS, dimensions), np.uint32)
    for column, (polynomial, start) in enumerate(zip(polynomials.tolist(), starts.tolist(), strict=True)):
        if column:
            degree = polynomial.bit_length() - 1
            own = start[:degree]
            for j in range(degree, SOBOL_BITS):
                terms = [own[j - k] << k for k in range(1, degree + 1) if polynomial >> (degree - k) & 1]
                own.append(functools.reduce(operator.xor, terms, own[j - degree]))
            numbers[:, column] = own
    return numbers << np.arange(SOBOL_BITS - 1, -1, -1, dtype=np.uint32)[:, None]


def _scrambled(seed: int, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Digital shift (dimensions,) and direction numbers, scrambled by random triangular matrices (Matoušek, 1998)."""
    bits, dimensions = directions.shape
    random, places = np.random.default_rng(seed).spawn(1)[0], np.arange(bits, dtype=np.uint32)
    shift = random.integers(2, size=(dimensions, bits), dtype=np.uint32) @ (np.uint32(1) << places)
    matrices = np.tril(random.integers(2, size=(dimensions, bits, bits), dtype=np.uint32))
    matrices[:, places, places] = 1
    digits = directions.T[:, None, :] >> places[::-1, None] & np.uint32(1)
    mixed = matrices @ digits & np.uint32(1)
    return shift, (mixed << places[::-1, None]).sum(axis=1, dtype=np.uint32).T


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
