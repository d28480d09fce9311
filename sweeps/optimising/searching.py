"""Search methods: differential evolution, NSGA-II, and a local search from a candidate."""

import warnings
from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.optimize import OptimizeResult, differential_evolution, minimize

from sweeps.optimising.trials import BEYOND, Evaluate, Trials
from sweeps.study.search_task import GENETIC, SearchTask
from sweeps.study.unit_points import latin_points
from sweeps.text.input_files import InputError
from sweeps.text.versions import extra

# Relative spread of a generation's costs at which evolution stops; the local search is better at the rest.
ALIKE = 1e-3

# Step of central differences as a share of the range: truncation and rounding (1e-14 over it) are both about 1e-9.
STEP = 1e-4
# Distance kept from the limits of conditions, so that rounding doesn't cross one.
CLEARANCE = 1e-9
STEPS, ROUNDS = 100, 5
STILL = 1e-9
# Change of the relative cost at which a descent ends; gains below it are errors of slopes.
LEVEL = 1e-10
# Entries of a list on either side that are tried in exchange.
REACH = 6


def first_generation(task: SearchTask) -> np.ndarray:
    """Coordinates (population, variables) of the start and a Latin hypercube."""
    points = latin_points(task.seed, task.population, task.variables.size, np.arange(task.population))
    points[0] = task.start
    return points


def search_method_of(task: SearchTask) -> Callable[[Evaluate], None]:
    """The search method of a task.

    Returns
    -------
    callable
        Takes a function that is called once per generation with coordinates (candidates, variables).

    Raises
    ------
    InputError
        NSGA-II is requested and pymoo isn't installed.
    """
    if task.method != GENETIC:
        return partial(_evolve, task)
    refusal = partial(InputError.of, f"{task.study.name}.toml", key="optimise.method")
    with extra("optimise", repr(GENETIC), refusal):
        from sweeps.optimising.genetic import breed
    return partial(breed, task, first_generation(task))


def _evolve(task: SearchTask, evaluate: Evaluate) -> None:
    """Differential evolution of one objective with Deb's rules.

    Of two feasible candidates the cheaper one wins, else the one with the smaller violation (Deb, "An efficient
    constraint handling method for genetic algorithms", Comput. Methods Appl. Mech. Eng. 186, 2000).
    """

    def costs(coordinates: np.ndarray) -> np.ndarray:
        batch = evaluate(coordinates.T)
        return np.where(batch.met, batch.costs[:, 0], BEYOND * (1.0 + batch.violation))

    def is_settled(intermediate_result: OptimizeResult) -> bool:
        """Whether the candidates are feasible and similar; violations may be similar far from any feasible one."""
        energies = intermediate_result.population_energies
        return energies.max() < BEYOND and np.std(energies) <= ALIKE * abs(np.mean(energies))

    bounds = [(0.0, 1.0)] * task.variables.size
    together = {"vectorized": True, "updating": "deferred", "polish": False}
    # No spread is below that: `is_settled` decides.
    end = {"maxiter": task.generations - 1, "atol": -1.0, "tol": 0.0, "callback": is_settled}
    differential_evolution(costs, bounds, init=first_generation(task), rng=task.seed, **together, **end)


def descend(task: SearchTask, trials: Trials, start: np.ndarray, steps: int = STEPS) -> list[dict[str, np.ndarray]]:
    """Local search from a candidate along its ranges, by sequential quadratic programming (SciPy's SLSQP).

    Parameters
    ----------
    task : SearchTask
        With one objective.
    trials : Trials
    start : ndarray (variables,)
        Coordinates; those of lists stay fixed.
    steps : int
        Maximum steps per restart. Restarts help where the objective has a kink, as a peak over the cycle has where
        another position takes over.

    Returns
    -------
    list of dict
        Columns of each feasible candidate.
    """
    here, least, passed = start, np.inf, []
    for _ in range(ROUNDS):
        slope = _Slope(task, trials, here)
        slope.go(steps)
        passed += slope.passed
        if slope.best is None or not slope.best[0] < least - STILL * abs(least):
            break
        least, here = slope.best
    return passed


def refine(task: SearchTask, trials: Trials, start: np.ndarray, least: float) -> list[dict[str, np.ndarray]]:
    """Local search from the best candidate: entries of lists by exchange, ranges by descent.

    The ranges' best depends on the entries, so it is sought for the next entries of each list too.

    Parameters
    ----------
    task : SearchTask
        With one objective.
    trials : Trials
    start : ndarray (variables,)
        Coordinates of a feasible candidate.
    least : float
        Its cost.

    Returns
    -------
    list of dict
        Columns of feasible candidates.
    """
    found, start, least = _exchange(task, trials, start, least)
    while task.variables.free.any():
        starts = [start, *_neighbours(task, start, _singles(task, 1))]
        passed = [one for here in starts for one in descend(task, trials, here)]
        found += passed
        costs = [float(trials.judged(one).costs[0, 0]) for one in passed]
        if len(starts) == 1 or not min(costs, default=np.inf) < least - STILL * abs(least):
            break
        least, best = min(costs), passed[int(np.argmin(costs))]
        start = task.variables.coordinates({name: float(best[name][0]) for name in task.variables.names})
    return found


def _singles(task: SearchTask, reach: int) -> np.ndarray:
    """Moves (moves, lists) of one list by up to `reach` entries."""
    one = np.eye(len(task.variables.choices), dtype=np.int64)
    return np.concatenate([step * one for step in range(-reach, reach + 1) if step])


def _neighbours(task: SearchTask, start: np.ndarray, moves: np.ndarray) -> np.ndarray:
    """Coordinates (candidates, variables) of other entries than those of a candidate, with its ranges."""
    sizes = np.array([axis.size for axis in task.variables.choices], np.int64)
    ranges = start.size - sizes.size
    entries = np.minimum((start[ranges:] * sizes).astype(np.int64), sizes - 1)
    near = np.unique(np.clip(entries + moves, 0, sizes - 1), axis=0)
    near = near[(near != entries).any(axis=1)]
    return np.column_stack([np.repeat(start[None, :ranges], len(near), axis=0), (near + 0.5) / sizes])


def _exchange(
    task: SearchTask, trials: Trials, start: np.ndarray, least: float
) -> tuple[list[dict[str, np.ndarray]], np.ndarray, float]:
    """Exchange entries of lists for others nearby, ranges unchanged, until no exchange is better.

    A condition may tie two lists together, so each entry is also exchanged together with the next one of another list.
    Returns the better candidates, and coordinates and cost of the last.
    """
    singles, steps, found = _singles(task, REACH), _singles(task, 1), []
    moves = np.concatenate([singles, *(singles + step for step in steps)])
    while (near := _neighbours(task, start, moves)).size:
        batch = trials.evaluate(near)
        costs = np.where(batch.met, batch.costs[:, 0], np.inf)
        best = int(np.argmin(costs))
        if not costs[best] < least:
            break
        start, least = near[best], costs[best]
        found.append({name: values[best : best + 1] for name, values in batch.columns.items()})
    return found, start, least


class _Slope:
    """Cost, conditions and their gradients along the free coordinates, one batch per point.

    Attributes
    ----------
    passed : list of dict
        Columns of the feasible points.
    best : (float, ndarray) or None
        Minimum cost of a feasible point, and its coordinates.
    """

    def __init__(self, task: SearchTask, trials: Trials, start: np.ndarray) -> None:
        self.trials, self.start, self.free = trials, start, np.flatnonzero(task.variables.free)
        self.passed: list[dict[str, np.ndarray]] = []
        self.best: tuple[float, np.ndarray] | None = None
        self._known: dict[bytes, tuple] = {}
        cost, _, parts, slopes = self._at(start[self.free])
        self.size = abs(cost) or 1.0
        # Drop conditions that no free coordinate influences.
        self.parts = np.flatnonzero((slopes != 0).any(axis=1) & np.isfinite(parts))

    def go(self, steps: int) -> None:
        """Run at most `steps` steps."""
        conditions = {
            "type": "ineq",
            "fun": lambda x: -self._at(x)[2][self.parts] - CLEARANCE,
            "jac": lambda x: -self._at(x)[3][self.parts],
        }
        with warnings.catch_warnings():
            # SciPy warns of steps that leave the bounds by rounding, and clips them.
            warnings.simplefilter("ignore", RuntimeWarning)
            minimize(
                lambda x: self._at(x)[0] / self.size,
                self.start[self.free],
                jac=lambda x: self._at(x)[1] / self.size,
                method="SLSQP",
                bounds=[(0.0, 1.0)] * self.free.size,
                constraints=[conditions] if self.parts.size else [],
                options={"maxiter": steps, "ftol": LEVEL},
            )

    def _at(self, x: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """Cost, its gradient, margins and their gradients (parts, free coordinates)."""
        x = np.clip(x, 0.0, 1.0)
        if x.tobytes() not in self._known:
            self._known[x.tobytes()] = self._found(x)
        return self._known[x.tobytes()]

    def _found(self, x: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        count = x.size
        points = np.repeat(self.start[None], 2 * count + 1, axis=0)
        moves = STEP * np.vstack([np.zeros(count), np.eye(count), -np.eye(count)])
        points[:, self.free] = np.clip(x + moves, 0.0, 1.0)
        batch = self.trials.evaluate(points)
        cost = batch.costs[:, 0]
        if batch.met[0]:
            self.passed.append({name: values[:1] for name, values in batch.columns.items()})
            if self.best is None or cost[0] < self.best[0]:
                self.best = float(cost[0]), points[0]
        places = points[:, self.free]
        there = places[1 : count + 1].diagonal(), places[count + 1 :].diagonal()
        slopes = [_slopes(row, x, *there) for row in (cost, *batch.margins)]
        known = float(cost[0]) if np.isfinite(cost[0]) else BEYOND
        return known, slopes[0], batch.margins[:, 0], np.reshape(slopes[1:], (-1, count))


def _slopes(values: np.ndarray, x: np.ndarray, above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Difference quotients from values at a point, above and below it; one-sided at a bound."""
    count = x.size
    here, up, down = values[0], values[1 : count + 1], values[count + 1 :]
    above, up = np.where(np.isfinite(up), (above, up), (x, np.full(count, here)))
    below, down = np.where(np.isfinite(down), (below, down), (x, np.full(count, here)))
    wide = above > below
    quotient = np.divide(up - down, above - below, out=np.zeros(count), where=wide)
    return np.where(np.isfinite(quotient), quotient, 0.0)
