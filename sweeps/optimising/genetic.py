"""NSGA-II from pymoo, evaluated by generations."""

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.duplicate import DuplicateElimination
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from sweeps.optimising.trials import BEYOND, Evaluate
from sweeps.study.search_task import SearchTask


class _Candidates(Problem):
    """A search in pymoo's form: costs and constraint violations."""

    def __init__(self, task: SearchTask, evaluate: Evaluate) -> None:
        super().__init__(n_var=task.variables.size, n_obj=len(task.objectives), n_ieq_constr=1, xl=0.0, xu=1.0)
        self.judge = evaluate

    def _evaluate(self, x: np.ndarray, out: dict, *_: object, **__: object) -> None:
        batch = self.judge(x)
        out["F"] = np.where(batch.met[:, None], batch.costs, BEYOND)
        out["G"] = batch.violation[:, None]


class _Twins(DuplicateElimination):
    """Compares candidates by their parameters: many coordinates select the same list entry."""

    def __init__(self, task: SearchTask) -> None:
        super().__init__()
        self.variables = task.variables

    def _do(self, pop: Population, other: Population | None, is_duplicate: np.ndarray) -> np.ndarray:
        def rows(of: Population) -> np.ndarray:
            return np.column_stack(list(self.variables.values(of.get("X")).values()))

        earlier = np.empty((0, len(self.variables.names))) if other is None else rows(other)
        whole = np.vstack([earlier, rows(pop)])
        is_first = np.zeros(len(whole), bool)
        is_first[np.unique(whole, axis=0, return_index=True)[1]] = True
        is_duplicate[~is_first[len(earlier) :]] = True
        return is_duplicate


def breed(task: SearchTask, first: np.ndarray, evaluate: Evaluate) -> None:
    """Search for the Pareto front of several objectives.

    NSGA-II of Deb, Pratap, Agarwal and Meyarivan (IEEE Trans. Evol. Comput. 6, 2002), with pymoo's settings.

    Parameters
    ----------
    task : SearchTask
    first : ndarray (population, variables)
        Coordinates of the first generation.
    evaluate : callable
        Called with the coordinates of each generation.
    """
    algorithm = NSGA2(pop_size=task.population, sampling=first, eliminate_duplicates=_Twins(task))
    minimize(_Candidates(task, evaluate), algorithm, ("n_gen", task.generations), seed=task.seed)
