"""Torques on the members of a gear train with mesh losses, and whether it moves at all.

A mesh transmits torque between its wheels in the ratio of their teeth, times η on the wheel driven as seen from the
carrier; the carrier takes the difference. The direction of power flow depends on the torques: assume directions, solve
and check.
"""

from itertools import product
from typing import NamedTuple

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Element
from engine.elements.gears.small_systems import solve
from engine.elements.gears.train_variants import TrainVariants, teeth_of
from engine.laws.rounding import EPS
from engine.stepping.records import put, some

# Powers below this multiple of the mesh's largest terms are rounding.
_NOTHING = 64 * EPS


class TrainMoments(NamedTuple):
    """Equilibrium of a train for assumed directions of power flow.

    Attributes
    ----------
    moments : Measured (shafts, variants)
        External torque on every shaft [N·m].
    tooth_moments : Measured (meshes, 2, variants)
        Torque of the mesh on each of its wheels [N·m].
    rolling_powers : Measured (meshes, variants)
        Power from the first wheel to the second, as seen from the carrier [W].
    senses : ndarray (meshes, variants)
        Signs of these powers.
    agrees, gives : ndarray (variants,) of bool
        Whether these are the assumed directions, and whether there is output power.
    """

    moments: Measured
    tooth_moments: Measured
    rolling_powers: Measured
    senses: np.ndarray
    agrees: np.ndarray
    gives: np.ndarray

    @property
    def moves(self) -> np.ndarray:
        """Whether the given torques move the train."""
        return self.agrees & self.gives


def train_moments(v: TrainVariants, efficiencies: np.ndarray, backwards: bool = False) -> TrainMoments:
    """Torques from equilibrium, with the directions of power flow.

    With large losses several sets of directions may be consistent: take the one with output power; if there is none,
    the train does not move, and its torques are NaN.

    Parameters
    ----------
    v : TrainVariants
    efficiencies : ndarray (meshes, variants)
        Efficiencies of the meshes with their carriers at rest.
    backwards : bool
        Whether the train turns backwards under the same torques.
    """
    structure = v.structure
    loads = np.zeros((len(structure.shafts), v.count))
    for i, name in enumerate(structure.shafts):
        if v.train.shafts[name].moment is not None:
            loads[i] = v.n[f"shafts.{name}.moment"]
    teeth = np.array([teeth_of(place, v.n) for place in structure.meshes])
    equilibrium = _Equilibrium(v.train, teeth, -v.speeds if backwards else v.speeds, loads, efficiencies)
    senses = np.zeros(efficiencies.shape)
    found = equilibrium.solved(senses)
    for _ in range(len(structure.meshes) + 2):
        again = ~found.agrees
        if not again.any():
            break
        senses = np.where(again, found.senses, senses)
        found = equilibrium.solved(senses)
    doubtful = np.flatnonzero(~found.moves)
    if doubtful.size and (efficiencies[:, doubtful] < 1.0).any():
        put(found, doubtful, some(equilibrium, doubtful).best())
    for part in (found.moments, found.tooth_moments, found.rolling_powers):
        part.value[..., ~found.moves] = np.nan
    return found


class _Equilibrium(NamedTuple):
    """Data of the equilibrium equations."""

    train: Element
    teeth: np.ndarray
    speeds: Measured
    loads: np.ndarray
    efficiencies: np.ndarray

    def solved(self, senses: np.ndarray) -> TrainMoments:
        """Equilibrium if first wheels drive where `senses` is 1, second wheels where −1, without losses where 0."""
        structure = self.train.structure
        count = len(structure.shafts)
        driven = np.stack([senses < 0, senses > 0], axis=1)
        ends = self.teeth * np.where(driven, self.efficiencies[:, None], 1.0)
        # Action of each mesh on every shaft for a unit tooth force.
        acts = structure.equations(ends).swapaxes(0, 1)[:count]
        unknown = structure.number_of(structure.unknown_moments)
        known = [i for i in range(count) if i not in unknown]
        solution, inverse = solve(acts[known], -self.loads[known][:, None])
        force = solution.value[:, 0]
        moments, errors = self.loads.copy(), EPS * np.abs(self.loads)
        with np.errstate(invalid="ignore"):
            # Non-integer coefficients contain efficiencies, which carry rounding.
            rounding = (acts[known] != np.rint(acts[known])) * (8.0 * EPS * np.abs(acts[known]))
            off = np.einsum("kjv,jv->kv", rounding, np.abs(force)) + EPS * np.abs(self.loads[known])
            force_errors = np.einsum("jkv,kv->jv", inverse, off) + 4.0 * EPS * np.abs(force)
            force_errors += solution.error[:, 0]
            moments[unknown] = -np.einsum("ujv,jv->uv", acts[unknown], force)
            errors[unknown] = np.einsum("ujv,jv->uv", np.abs(acts[unknown]), force_errors + 8.0 * EPS * np.abs(force))
            shares = np.where(force == 0, 0.0, force_errors / np.abs(force))
            pulls = Measured(force, force_errors) * self.teeth[:, 0]
            first, carrier = (self.speeds[[getattr(p, key) for p in structure.meshes]] for key in ("first", "carrier"))
            rolling = -pulls * (first - carrier)
            powers, largest = rolling.value, np.abs(pulls.value) * (np.abs(first.value) + np.abs(carrier.value))
            follows = np.where(np.abs(powers) > _NOTHING * largest, np.sign(powers), 0.0)
            agrees = ((follows == senses) | (follows == 0) | (self.efficiencies == 1.0)).all(axis=0)
            all_moments = Measured(moments, errors)
            given = all_moments * self.speeds[:-1]
            out = np.minimum(given.value + given.error, 0.0).sum(axis=0)
            into = np.maximum(given.value - given.error, 0.0).sum(axis=0)
        # Without input power none is required at the output: torques that do no work are in equilibrium.
        gives = (out < 0) | (into <= 0)
        pulls = ends * force[:, None]
        tooth_moments = Measured(pulls, np.abs(pulls) * shares[:, None])
        return TrainMoments(all_moments, tooth_moments, rolling, follows, agrees, gives)

    def best(self) -> TrainMoments:
        """The solution of maximum output power among all consistent directions."""
        found = None
        for signs in product((1.0, -1.0), repeat=len(self.teeth)):
            senses = np.broadcast_to(np.array(signs)[:, None], self.efficiencies.shape)
            tried = self.solved(senses)
            if found is None:
                found = tried
                continue
            better = _quality(self, tried) > _quality(self, found)
            put(found, better, some(tried, better))
        return found


def _quality(equilibrium: _Equilibrium, solved: TrainMoments) -> np.ndarray:
    """Output power over input power; −1 if directions are inconsistent or there is no output power."""
    with np.errstate(invalid="ignore", divide="ignore"):
        given = solved.moments.value * equilibrium.speeds.value[:-1]
        share = -np.minimum(given, 0.0).sum(axis=0) / np.maximum(given, 0.0).sum(axis=0)
    return np.where(solved.moves, np.nan_to_num(share, nan=1.0), -1.0)
