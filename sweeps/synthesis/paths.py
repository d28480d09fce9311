"""Crank-rockers whose coupler point follows a closed path, found by search.

Differential evolution over the linkage's shape (link ratios, coupler point) compares paths normalised in size and
position; the best one is refined by least squares in all lengths and positions.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import differential_evolution, least_squares

from sweeps.synthesis.synthesis_error import SynthesisError

# Points on paths in the search, the refinement and the final error.
_COARSE, _FINE, _TOLD = 64, 360, 7200
# Bounds: logarithms of link lengths over the crank, and coupler point over the coupler length.
_BOUNDS = [(0.05, 2.5)] * 3 + [(-2.5, 2.5)] * 2 + [(-math.pi, math.pi)]
_POPULATION, _GENERATIONS = 20, 120
# Error assigned to a linkage whose crank doesn't turn fully.
_NO_LINKAGE = 1e3


class PathFourBar(NamedTuple):
    """A crank-rocker with a coupler point that follows a path.

    Attributes
    ----------
    crank_pivot, rocker_pivot : complex
        x + iy [m].
    crank, coupler, rocker : float
        Lengths [m].
    mode : int
        Assembly mode, as for a dyad RRR.
    point : complex
        The coupler point from the crank's pin, along the coupler and to its left [m].
    rms, greatest : float
        Distance of the target points from the path, rms and maximum [m].
    """

    crank_pivot: complex
    rocker_pivot: complex
    crank: float
    coupler: float
    rocker: float
    mode: int
    point: complex
    rms: float
    greatest: float


def four_bar_along(points: Sequence[complex], seed: int = 0) -> PathFourBar:
    """Crank-rocker whose coupler point follows a closed path as closely as possible.

    Parameters
    ----------
    points : sequence of complex
        Points on the path in order, x + iy [m]; it closes from the last to the first.
    seed : int
        Random seed; other seeds may find other linkages.

    Raises
    ------
    SynthesisError
        Fewer than five points, or they enclose no area.
    """
    wanted = np.asarray(points, complex)
    if wanted.size < 5 or not np.isfinite(wanted).all():
        raise SynthesisError(f"a path needs at least five finite points; {wanted.size} given")
    off = wanted - wanted.mean()
    spread = np.linalg.svd(np.stack([off.real, off.imag]), compute_uv=False)
    if not spread[-1] > 1e-6 * spread[0]:
        raise SynthesisError("the points are collinear: the path must enclose an area")
    dense = _spread(wanted, _COARSE)
    centre, size = _centre_and_size(dense[None, :])
    normal = (dense - centre[0]) / size[0]
    found = [_searched(normal, mode, seed) for mode in (1, -1)]
    mode, shape = min(zip((1, -1), found, strict=True), key=lambda pair: pair[1].fun)
    start = _placed(shape.x, mode, centre[0], size[0])
    parts = _brought_nearer(start, mode, wanted, dense, float(size[0]))
    apart = np.abs(_to_curve(wanted, _path(parts, mode, _TOLD)))
    first, other = complex(parts[0], parts[1]), complex(parts[2], parts[3])
    lengths = [float(value) for value in np.exp(parts[4:7])]
    at = complex(parts[7], parts[8]) * lengths[1]
    return PathFourBar(first, other, *lengths, mode, at, float(np.sqrt(np.mean(apart**2))), float(apart.max()))


def _searched(normal: np.ndarray, mode: int, seed: int) -> object:
    def errors(shapes: np.ndarray) -> np.ndarray:
        links = np.exp(shapes[:3])
        paths = _coupler_paths(*links, shapes[3] + 1j * shapes[4], mode, _COARSE)
        turns = _turns(*links)
        with np.errstate(invalid="ignore"):
            centre, size = _centre_and_size(paths)
            paths = (paths - centre[:, None]) / size[:, None] * np.exp(1j * shapes[5])[:, None]
            apart = np.abs(paths[:, :, None] - normal[None, None, :])
            error = (apart.min(axis=1) ** 2).mean(axis=1) + (apart.min(axis=2) ** 2).mean(axis=1)
        return np.where(turns & np.isfinite(error), error, _NO_LINKAGE)

    together = {"vectorized": True, "updating": "deferred", "polish": False}
    size = {"popsize": _POPULATION, "maxiter": _GENERATIONS, "tol": 1e-8}
    return differential_evolution(errors, _BOUNDS, seed=seed, **size, **together)


def _turns(coupler: np.ndarray, rocker: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """Whether a crank of length 1 turns fully: Grashof's rule, the crank the shortest."""
    longest = np.maximum(np.maximum(coupler, rocker), frame)
    return 1.0 + longest < 0.999 * (coupler + rocker + frame - longest)


def _coupler_paths(
    coupler: np.ndarray, rocker: np.ndarray, frame: np.ndarray, point: np.ndarray, mode: int, places: int
) -> np.ndarray:
    """Coupler paths of linkages with a crank of length 1 at the origin (linkages, points)."""
    pins = np.exp(2j * np.pi * np.arange(places) / places)[None, :]
    to = frame[:, None] - pins
    apart = np.abs(to)
    inside = (coupler[:, None] ** 2 + apart**2 - rocker[:, None] ** 2) / (2.0 * coupler[:, None] * apart)
    with np.errstate(invalid="ignore"):
        along = to / apart * np.exp(1j * mode * np.arccos(inside))
    return pins + (point * coupler)[:, None] * along


def _centre_and_size(paths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centres of closed polygons as wires, and their radii of gyration."""
    after = np.roll(paths, -1, axis=1)
    length, middle = np.abs(after - paths), 0.5 * (after + paths)
    whole = length.sum(axis=1)
    centre = (length * middle).sum(axis=1) / whole
    return centre, np.sqrt((length * np.abs(middle - centre[:, None]) ** 2).sum(axis=1) / whole)


def _spread(points: np.ndarray, count: int) -> np.ndarray:
    """Equally spaced points along a closed polygon."""
    closed = np.append(points, points[0])
    along = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(closed)))))
    places = np.arange(count) * along[-1] / count
    return np.interp(places, along, closed.real) + 1j * np.interp(places, along, closed.imag)


def _placed(shape: np.ndarray, mode: int, centre: complex, size: float) -> np.ndarray:
    """Both pivots, logarithms of the lengths, and the point, of a shape fitted to the target path."""
    links = np.exp(shape[:3])[:, None]
    own, radius = _centre_and_size(_coupler_paths(*links, np.array([complex(shape[3], shape[4])]), mode, _COARSE))
    turned = size / radius[0] * np.exp(1j * shape[5])
    first = centre - own[0] * turned
    other = first + links[2, 0] * turned
    lengths = np.log(abs(turned) * np.array([1.0, links[0, 0], links[1, 0]]))
    return np.array([first.real, first.imag, other.real, other.imag, *lengths, shape[3], shape[4]])


def _path(parts: np.ndarray, mode: int, places: int) -> np.ndarray:
    """Coupler path from both pivots, logarithms of the lengths, and the point."""
    first, frame = complex(parts[0], parts[1]), complex(parts[2] - parts[0], parts[3] - parts[1])
    crank, coupler, rocker = np.exp(parts[4:7])
    sizes = (np.array([length / crank]) for length in (coupler, rocker, abs(frame)))
    path = _coupler_paths(*sizes, np.array([complex(parts[7], parts[8])]), mode, places)[0]
    return first + crank * frame / abs(frame) * path


def _to_curve(points: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Vectors from points to the nearest points of a closed polygon (points,)."""
    step = np.roll(curve, -1) - curve
    gap = points[:, None] - curve[None, :]
    share = np.clip((gap * step.conj()).real / np.maximum(np.abs(step) ** 2, 1e-300), 0.0, 1.0)
    apart = gap - share * step
    return apart[np.arange(points.size), np.abs(apart).argmin(axis=1)]


def _brought_nearer(start: np.ndarray, mode: int, wanted: np.ndarray, dense: np.ndarray, size: float) -> np.ndarray:
    """Residuals for least squares: distances from the target points to the path, and back."""
    weight = math.sqrt(wanted.size / _FINE)

    def apart(parts: np.ndarray) -> np.ndarray:
        path = _path(parts, mode, _FINE)
        if not np.isfinite(path).all():
            return np.full(2 * (wanted.size + _FINE), _NO_LINKAGE)
        # Half the weight, as the target is unknown between its points.
        both = np.concatenate([_to_curve(wanted, path), 0.5 * weight * _to_curve(path, dense)]) / size
        return np.concatenate([both.real, both.imag])

    scale = np.array([size] * 4 + [1.0] * 5)
    end = least_squares(apart, start, x_scale=scale, max_nfev=200).x
    return end if np.sum(apart(end) ** 2) < np.sum(apart(start) ** 2) else start
