"""Rotors: unbalance, feasible correction, resulting balance quality.

The balance quality is the minimum product e ω of specific unbalance and speed whose tolerances in the planes of both
bearings admit the rotor.

Source: ISO 21940-11; the equations are those of this package's other modules.
"""

import math
from contextlib import suppress
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Answers, Columns, Element, NamedRows, Numbers, nudged
from engine.elements.panels import Curve, Panel, PanelAxis
from engine.elements.rotors.correction import correct, corrected_unbalance
from engine.elements.rotors.grades import grade_reached, permissible_unbalance, tolerance_shares
from engine.elements.rotors.hole_pattern import PatternError, best_holes
from engine.elements.rotors.knife_edges import knife_edge_results
from engine.elements.rotors.rotor_parts import CorrectionPlane, Unbalance
from engine.elements.rotors.unbalance import (
    Resultant,
    kind,
    resultant_unbalance,
    single_plane,
    unbalance,
    unbalance_in_two_planes,
    vector_polygon,
)
from engine.parts.bodies import STANDARD_GRAVITY
from engine.parts.skeleton import AngularSpeed, Faults, Length, Mass, Name, Speed
from engine.words.quantity import Quantity, main_result

# A number this close to an integer counts as one: error estimates nudge the numbers.
WHOLE = 1e-6
# Operations that compute a correction, each with its rounding.
STEPS = 32


_SIDES = ("first", "second")
# States of balance, as they end the names of results.
_STATES = {"before": "before balancing", "after": "after balancing", "at_worst": "with all errors of mass and angle"}
_KINDS = "kind of unbalance (0 within the grade, 1 static, 2 couple, 3 quasi-static, 4 dynamic)"
_SINGLE_PLANE = "position at which a single correction leaves the least couple"
_PERMISSIBLE = "permissible residual unbalance in the plane of the"


class RotorElement(Element):
    """A rigid rotor in two bearings, with masses off its axis and correction planes.

    `centre` is the position of the centre of mass along the axis, as are the positions of bearings and planes. `grade`
    is the balance quality G as the product of specific unbalance and speed, "6.3 mm/s" for G 6.3. `rolling_arm` is the
    arm of rolling friction on knife edges.
    """

    picture: ClassVar = "plan"

    type: Literal["rotor"]
    mass: Annotated[Mass, Field(gt=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    centre: Length
    first_bearing: Length
    second_bearing: Length
    grade: Annotated[Speed, Field(gt=0)] = 0.0063
    unbalances: Annotated[dict[Name, Unbalance], Field(min_length=1)]
    planes: Annotated[dict[Name, CorrectionPlane], Field(min_length=1)]
    rolling_arm: Annotated[Length, Field(gt=0)] | None = None

    def _faults(self) -> Faults:
        if self.first_bearing == self.second_bearing:
            yield "first_bearing and second_bearing coincide; give two positions"
        positions = [plane.position for plane in self.planes.values()]
        if len(positions) > 1 and len(set(positions)) == 1:
            yield f"planes {', '.join(self.planes)} coincide; move one, or leave all but one out"

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates by nudging all numbers, and the corrections added as well.

        A balanced rotor's residual is rounding of the corrections only, which no change of its numbers reveals.
        """
        added = {f"planes.{name}.added": np.ones_like(n["mass"]) for name in self.planes}
        return Answers(*nudged(self.values, n | added))

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name; NaN if there is no such rotor or correction."""
        return {name: np.where(np.isfinite(row), row, math.nan) for name, row in super().values(n).items()}

    def named(self, n: Numbers) -> NamedRows:
        """Results of the rotor and of its planes."""
        unbalances, places = _unbalances(self, n)
        before = resultant_unbalance(unbalances, places, n["first_bearing"])
        made, planes, added = _corrections(self, n, before)
        after = corrected_unbalance(before, made, planes)
        bearings = n["first_bearing"], n["second_bearing"]
        forces = [np.square(n["speed"]) * unbalance_in_two_planes(state, *bearings) for state in (before, after)]
        # The weight on each bearing of a horizontal rotor; the rotating force points along it once a turn.
        weight, arms = n["mass"] * STANDARD_GRAVITY, np.array([bearings[1] - n["centre"], n["centre"] - bearings[0]])
        peaks = [np.abs(force) + np.abs(weight * arms / (bearings[1] - bearings[0])) for force in forces]
        permissible = permissible_unbalance(n["grade"], n["mass"], n["speed"])
        allowed_couple = permissible * np.abs(bearings[1] - bearings[0])
        shares = np.array(tolerance_shares(n["centre"], *bearings))
        yield main_result("unbalance", "resultant unbalance", "kg m"), np.abs(before.unbalance)
        couple = np.abs(resultant_unbalance(unbalances, places, n["centre"]).moment)
        yield main_result("couple", "moment unbalance about the centre of mass", "kg m2"), couple
        found = kind(before, n["centre"], permissible, allowed_couple).astype(float)
        yield Quantity("kind", _KINDS, "1", exact=True), found
        # Moments about the origin: those about a bearing would add the rounding of its position.
        level = single_plane(resultant_unbalance(unbalances, places))
        yield Quantity("single_plane", _SINGLE_PLANE, "m", may_be_undefined=True), level
        yield main_result("permissible_unbalance", "permissible residual unbalance", "kg m"), permissible
        for side, share in zip(_SIDES, shares, strict=True):
            yield Quantity(f"{side}_permissible", f"{_PERMISSIBLE} {side} bearing", "kg m"), share * permissible
        yield from _qualities(n, (before, after), made, planes, permissible, shares, _correction_errors(self, n))
        for name, force, weight, states in (
            ("force", "rotating force", "", forces),
            ("peak", "force", " with the weight", peaks),
        ):
            for when, described, rows in zip(("before", "after"), (Quantity, main_result), states, strict=True):
                for side, row in zip(_SIDES, rows, strict=True):
                    words = f"{force} on the {side} bearing{weight} {when} balancing"
                    yield described(f"{side}_{name}_{when}", words, "N"), np.abs(row)
        mass = sum(row for result, row in added if result.units == "kg")
        yield main_result("correction_mass", "mass added in all planes", "kg"), mass
        yield from knife_edge_results(np.abs(before.unbalance), n)
        yield from added

    def panels(self) -> tuple[Panel, ...]:
        """Polygons of unbalances and of moments about the first plane; unbalance at the bearings before and after."""
        n = self.own_numbers()
        unbalances, where = _unbalances(self, n)
        before = resultant_unbalance(unbalances, where, n["centre"])
        made, planes, _ = _corrections(self, n, before)
        bearings = n["first_bearing"], n["second_bearing"]
        states = before, corrected_unbalance(before, made, planes)
        left = [np.abs(np.squeeze(unbalance_in_two_planes(state, *bearings))) for state in states]
        allowed = permissible_unbalance(n["grade"], n["mass"], n["speed"])
        allowed = np.squeeze(allowed * tolerance_shares(n["centre"], *bearings))
        names = *self.unbalances, *self.planes
        vectors, arms = np.append(unbalances[0], made[0]), np.append(where[0], planes[0]) - planes[0, 0]
        words = zip(("before", "after", "permissible"), (*left, allowed), strict=True)
        bars = [Curve(word, row) for word, row in words]
        x, y = PanelAxis("bearing", "1"), PanelAxis("unbalance", "kg m", "U")
        about_plane = f"Moments about plane {names[len(self.unbalances)]}"
        limits = max(left[1].min(), 1e-3 * allowed.min()) / 3.0, 20.0 * max(left[0].max(), allowed.max())
        at_bearings = Panel(x, y, np.arange(2.0), bars, (), "At the bearings", limits, "bars", ("first", "second"))
        forces = vector_polygon(names, vectors, len(planes[0]), "Unbalances", "kg m")
        return forces, vector_polygon(names, vectors * arms, len(planes[0]), about_plane, "kg m2"), at_bearings


def _hole_results(name: str, places: np.ndarray, pieces: np.ndarray) -> NamedRows:
    """Numbers of the holes used in a plane, and of their pieces, each (variants, used)."""
    yield main_result(f"{name}.pieces", f"pieces added in plane {name}", "1", exact=True), pieces.sum(axis=-1)
    for k, (hole, own) in enumerate(zip(places.T, pieces.T, strict=True), 1):
        words = f"hole {k} used in plane {name}, counted from 1 (0 for none)"
        yield main_result(f"{name}.hole_{k}", words, "1", exact=True), hole
        yield main_result(f"{name}.pieces_{k}", f"pieces in hole {k} used in plane {name}", "1", exact=True), own


def _correction_errors(rotor: RotorElement, n: Numbers) -> np.ndarray:
    """Relative error of each plane's correction (planes, variants): |(1 + μ) exp(i δ) − 1|, about √(μ² + δ²).

    This is the maximum for errors of either sign up to μ of the mass or the radius, and δ of the angle.
    """
    at = [f"planes.{name}" for name in rotor.planes]
    mass, angle = (np.stack([n[f"{p}.{key}"] for p in at]) for key in ("mass_error", "angle_error"))
    return np.sqrt(mass**2 + 4.0 * (1.0 + mass) * np.sin(angle / 2.0) ** 2)


def _qualities(
    n: Numbers,
    states: tuple[Resultant, Resultant],
    made: np.ndarray,
    planes: np.ndarray,
    permissible: np.ndarray,
    shares: np.ndarray,
    off: np.ndarray,
) -> NamedRows:
    """Quality and grade before, after, and with all errors adding up."""
    first, second = n["first_bearing"], n["second_bearing"]
    before, after = (np.abs(unbalance_in_two_planes(state, first, second)) for state in states)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        levers = np.stack([planes.T - second, first - planes.T]) / (first - second)
        # Correction of each plane resolved into the planes of the bearings: (bearings, planes, variants).
        felt = np.abs(levers * made.T)
        room = ((shares * permissible - after) / felt.sum(axis=1)).min(axis=0)
    residuals = before, after, after + (felt * off).sum(axis=1)
    # The least e ω whose tolerances in both planes admit the residual unbalances.
    needed = [(row / shares).max(axis=0) * np.abs(n["speed"]) / n["mass"] for row in residuals]
    for (state, words), quality in zip(_STATES.items(), needed, strict=True):
        yield Quantity(f"quality_{state}", f"balance quality e ω {words}", "m s-1"), quality
    for (state, words), quality in zip(_STATES.items(), needed, strict=True):
        grade = main_result(f"grade_{state}", f"finest grade G held {words}", "m s-1", True, True)
        yield grade, grade_reached(quality) / 1000
    words = "relative error of all corrections that the grade allows"
    yield Quantity("error_allowance", words, "1", True), room


def _unbalances(rotor: RotorElement, n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Unbalances of a rotor, complex [kg·m], and their positions [m], each (variants, unbalances)."""
    at = [f"unbalances.{name}" for name in rotor.unbalances]
    parts = [unbalance(n[f"{u}.mass"], n[f"{u}.radius"], n[f"{u}.angle"]) for u in at]
    return np.stack(parts, axis=-1), np.stack([n[f"{u}.position"] for u in at], axis=-1)


def _corrections(rotor: RotorElement, n: Numbers, before: Resultant) -> tuple[np.ndarray, np.ndarray, list]:
    """Unbalances added, in whole pieces if the plane has holes [kg·m], their positions [m], and results of each plane.

    Both arrays are (variants, planes).
    """
    at = [f"planes.{name}" for name in rotor.planes]
    positions, radii = (np.stack([n[f"{p}.{key}"] for p in at], axis=-1) for key in ("position", "radius"))
    wanted = correct(before, positions, radii)
    made, added = np.empty_like(wanted), []
    for k, (name, plane) in enumerate(rotor.planes.items()):
        meant, path, in_holes = wanted[:, k], at[k], []
        mass = np.abs(meant) / radii[:, k]
        if plane.holes is not None:
            meant, places, pieces = _in_holes(plane, n, path, meant)
            mass, in_holes = pieces.sum(axis=-1) * n[f"{path}.piece"], _hole_results(name, places, pieces)
        added.append((main_result(f"{name}.mass", f"mass added in plane {name}", "kg"), mass))
        angle = main_result(f"{name}.angle", f"angle of the mass added in plane {name}", "rad")
        added += [(angle, np.angle(meant) % math.tau), *in_holes]
        made[:, k] = meant * n.get(f"{path}.added", 1.0) ** STEPS
    return made, positions, added


def _in_holes(plane: CorrectionPlane, n: Numbers, path: str, wanted: np.ndarray) -> tuple[np.ndarray, ...]:
    """Unbalances by whole pieces, the holes used, and their pieces; NaN for patterns that cannot be searched."""
    holes, piece, first = n[f"{path}.holes"], n[f"{path}.piece"] * n[f"{path}.radius"], n[f"{path}.first_hole"]
    made = np.full_like(wanted, math.nan)
    places, pieces = np.full((2, wanted.size, plane.used), math.nan)
    counts = np.round(holes)
    counts[np.abs(holes - counts) > WHOLE] = math.nan
    for count in np.unique(counts[np.isfinite(counts)]):
        here = np.flatnonzero(counts == count)
        # A pattern that cannot be searched stays NaN, as does a fractional number of holes.
        with suppress(PatternError):
            filled, made[here] = best_holes(wanted[here], int(count), plane.most, plane.used, piece[here], first[here])
            places[here], pieces[here] = _holes_used(filled, plane.used)
    pieces[np.isnan(made)] = places[np.isnan(made)] = math.nan
    return made, places, pieces


def _holes_used(filled: np.ndarray, used: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers, from 1, of the holes with pieces, and their numbers of pieces: (variants, used), 0 for none."""
    padded = np.pad(filled, ((0, 0), (0, used)))
    order = np.argsort(padded == 0, axis=1, kind="stable")[:, :used]
    pieces = np.take_along_axis(padded, order, axis=1)
    return np.where(pieces > 0, order + 1, 0), pieces
