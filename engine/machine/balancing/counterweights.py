"""Counterweights on the links of a mechanism: full balance of its shaking force, or minimum residual force.

A counterweight m at the radius e on a link that turns about a fixed axis adds −m e d²u/dt² to the shaking force, with u
its direction: linear in the balancing vector m e, whose direction on the link is free. On any other link, and whenever
its moment counts, a counterweight has a given position on the link and adds −m a: linear in its mass. The optimum is
therefore exact, whatever the mechanism; see `engine.machine.balancing.least_shaking`.

Full balance of the force requires that the mass centre of all links can be made stationary. Four-bars are balanced by
counterweights on crank and rocker: the coupler's mass is replaced by masses in its two hinges, and the mass moving with
each of the two links is balanced on that link. A slider-crank needs a position on its rod beyond the crankpin. Shafts
with a pivot on the frame that are geared to the crank can carry counterweights as well: with the ratio −1 in addition
to the crank, and with 2 and −2, they form a Lanchester balancer.

Source: R. S. Berkof, G. G. Lowen, A new method for completely force balancing simple linkages (1969), the method of
linearly independent vectors; I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on balancing.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from engine.machine.balancing.least_shaking import DependentError, Optimum, Unknown, least_peak, least_rms
from engine.machine.machine import Machine
from engine.parts.bodies import Body
from engine.scene.scene import Scene
from engine.units.display import quantity_text
from engine.words.glossary import did_you_mean
from engine.words.user_error import UserError
from engine.words.verdicts import Verdict

# Tolerance for a full balance, relative to the sum of all terms; kinematics near dead centres lose digits.
FULL = 1e-10
ROWS = ("shaking_force_x", "shaking_force_y", "shaking_moment")

Criterion = Literal["full", "rms", "peak"]


class BalanceError(UserError, ValueError):
    """A balance that is impossible or wrongly specified."""


class CounterweightPlace(NamedTuple):
    """A position on a link for a counterweight, in the link's axes [m]; its unknown mass is at most `most` [kg]."""

    link: str
    x: float
    y: float = 0.0
    most: float = math.inf


class Counterweight(NamedTuple):
    """A counterweight of the solution: a mass [kg] at (x, y) in its link's axes [m]."""

    link: str
    mass: float
    x: float
    y: float

    @property
    def unbalance(self) -> float:
        """Mass times radius [kg·m]."""
        return self.mass * math.hypot(self.x, self.y)


class BalancedMachine(NamedTuple):
    """A machine with its counterweights.

    Attributes
    ----------
    scene : Scene
        With a body for each counterweight, named after its link: LINK_counterweight.
    counterweights : tuple of Counterweight
    before, after : float
        The criterion without and with the counterweights [N].
    bound : float
        Proven lower bound for all such counterweights [N]; `after` − `bound` is the optimality gap.
    """

    scene: Scene
    counterweights: tuple[Counterweight, ...]
    before: float
    after: float
    bound: float


def balance(
    scene: Scene,
    links: Sequence[str] = (),
    places: Sequence[CounterweightPlace] = (),
    criterion: Criterion = "full",
    radius: float | None = None,
    most: Mapping[str, float] | None = None,
    moment_weight: float = 0.0,
    positions: int = 360,
) -> BalancedMachine:
    """Find the counterweights that balance a machine at constant crank speed.

    Parameters
    ----------
    scene : Scene
        With a crank that turns fully.
    links : sequence of str
        Links that turn about fixed axes, for counterweights in the optimal direction.
    places : sequence of CounterweightPlace
        Positions on any links, for counterweights of optimal mass.
    criterion : {"full", "rms", "peak"}
        No shaking force; minimum rms over the cycle; minimum peak over the positions.
    radius : float, optional
        Radius of the counterweights on `links` [m]; by default the crank length.
    most : mapping of str to float, optional
        Maximum mass times radius on some of the `links` [kg·m].
    moment_weight : float
        Weight of the shaking moment relative to the two components of the force [1/m].
    positions : int
        Even; peaks between positions are missed.

    Raises
    ------
    BalanceError
        A link can't have such a counterweight, counterweights cancel each other, or full balance is impossible.
    SceneError
        The scene can't be ordered.
    """
    machine = Machine(scene, fields=ROWS[: 3 if moment_weight else 2], positions=positions)
    _check(machine, links, places, criterion, dict(most or {}), moment_weight)
    names = [*links, *(place.link for place in places)]
    rows = _rows(machine, {})[0]
    probes, columns = _probes(scene, links, places)
    effects = _rows(Machine(probes, (), machine.asked_fields, columns, positions), columns)
    scale = np.array([1.0, 1.0, moment_weight])[: rows.shape[1]]
    limits = [Unknown(2, (most or {}).get(link, math.inf)) for link in links]
    limits += [Unknown(1, place.most) for place in places]
    with np.errstate(over="ignore"):
        bounded = np.isfinite(effects).all() and np.isfinite(np.square(rows)).all()
    if not bounded:
        raise BalanceError("the shaking force is infinite: reduce masses, lengths or speeds")
    solve = least_peak if criterion == "peak" else least_rms
    try:
        found = solve(np.moveaxis(effects, 0, 2) * scale[:, None], rows * scale, limits)
    except DependentError as error:
        twice = sorted({_owner(int(i), names, len(links)) for i in error.columns})
        raise BalanceError(
            f"counterweights on {' and '.join(twice)} have the same effect, or none; leave one of them out"
        ) from None
    before = _size(rows * scale, criterion)
    if criterion == "full":
        _check_full(found, rows, effects, names)
    radius = _radius(scene, radius)
    weights = _weights(found.unknowns, links, places, radius)
    return BalancedMachine(_with(scene, weights), weights, before, found.value, found.bound)

    # Checks


def _check(
    machine: Machine,
    links: Sequence[str],
    places: Sequence[CounterweightPlace],
    criterion: str,
    most: dict[str, float],
    moment_weight: float,
) -> None:
    scene, turning = machine.scene, machine.mechanics.kinematics.links
    if not scene.has_cycle:
        raise BalanceError("the crank must turn fully: leave out input.start and input.stop")
    if criterion not in ("full", "rms", "peak"):
        raise BalanceError(f"criterion = {criterion!r}: allowed are 'full', 'rms' and 'peak'")
    if not links and not places:
        raise BalanceError("no link may have a counterweight: name links, or places on links")
    known = machine.mechanics.structure.links
    for link in (*links, *(place.link for place in places)):
        if link not in known:
            raise BalanceError(f"{link!r} is not a link of this scene; {did_you_mean(link, known)}")
    zero = machine.mechanics.graph.zero
    fixed = [n for n in known if turning[n].w is not zero and set(turning[n].origin.v) == {zero}]
    for link in links:
        if link not in fixed:
            raise BalanceError(f"{link!r} doesn't turn about a fixed axis: give a place on it; or {_listed(fixed)}")
        if moment_weight and turning[link].e is not zero:
            raise BalanceError(f"the moment of a counterweight on {link!r} depends on its radius: give a place on it")
    for link, value in most.items():
        if link not in links or not value > 0:
            raise BalanceError(f"most[{link!r}] = {value!r}: give mass times radius above 0, for one of {list(links)}")


def _listed(links: Sequence[str]) -> str:
    return f"choose from {', '.join(links)}" if links else "none here does"


def _check_full(found: Optimum, rows: np.ndarray, effects: np.ndarray, names: Sequence[str]) -> None:
    """Check that the residual is rounding, relative to the sum of all terms."""
    terms = np.abs(rows).mean() + np.abs(effects * found.unknowns[:, None, None]).sum(axis=0).mean()
    if found.value > FULL * terms:
        raise BalanceError(
            f"counterweights on {', '.join(names)} don't balance this machine fully: "
            f"{quantity_text(found.value, 'N')} are left at "
            "best, rms; allow counterweights on more links, or use criterion 'rms' or 'peak'"
        )


def _radius(scene: Scene, radius: float | None) -> float:
    radius = scene.input.length if radius is None else radius
    if radius is None:
        raise BalanceError("without a crankpin there is no default radius for the counterweights: give radius")
    if not radius > 0:
        raise BalanceError(f"radius = {radius!r}: give a positive distance of the counterweights from the axis")
    return radius


# Shaking force


def _rows(machine: Machine, varied: Mapping[str, np.ndarray]) -> np.ndarray:
    """Shaking force and moment of every variant, (variants, positions, parts)."""
    outcome = machine.evaluate(varied)
    failed = np.flatnonzero(outcome.status)
    if failed.size:
        raise BalanceError(f"the machine can't be balanced: {Verdict(int(outcome.status[failed[0]])).sentence}")
    return np.stack([outcome.fields[name] for name in machine.asked_fields], axis=-1)


def _probes(
    scene: Scene, links: Sequence[str], places: Sequence[CounterweightPlace]
) -> tuple[Scene, dict[str, np.ndarray]]:
    """The massless mechanism with a mass for each unknown, and the masses' values: one of 1 kg in each variant."""
    at = [(link, *direction) for link in links for direction in ((1.0, 0.0), (0.0, 1.0))]
    at += [(place.link, place.x, place.y) for place in places]
    bodies = {f"probe{i}": Body(link=link, mass=0.0, x=x, y=y) for i, (link, x, y) in enumerate(at)}
    bare = {name: shaft.model_copy(update={"inertia": 0.0}) for name, shaft in scene.shafts.items()}
    moving = ("points", "guides", "groups", "links", "near", "cams", "inputs", "racks", "pinions", "noncircular_wheels")
    kept = {table: getattr(scene, table) for table in (*moving, "balance")}
    probes = Scene(input=scene.input).model_copy(update={**kept, "shafts": bare, "bodies": bodies})
    masses = np.eye(len(at))
    return probes, {f"bodies.{name}.mass": masses[i] for i, name in enumerate(bodies)}


def _owner(column: int, names: Sequence[str], vectors: int) -> str:
    """Link of an unknown; each of the first `vectors` links has two."""
    return names[column // 2] if column < 2 * vectors else names[column - vectors]


def _size(rows: np.ndarray, criterion: str) -> float:
    squares = (rows**2).sum(axis=1)
    return float(np.sqrt(squares.max() if criterion == "peak" else squares.mean()))


# Counterweights


def _weights(
    unknowns: np.ndarray, links: Sequence[str], places: Sequence[CounterweightPlace], radius: float
) -> tuple[Counterweight, ...]:
    found = []
    for i, link in enumerate(links):
        x, y = unknowns[2 * i : 2 * i + 2].tolist()
        size = math.hypot(x, y)
        direction = (x / size, y / size) if size > 0 else (1.0, 0.0)
        found.append(Counterweight(link, size / radius, radius * direction[0], radius * direction[1]))
    masses = unknowns[2 * len(links) :].tolist()
    found += [Counterweight(p.link, mass, p.x, p.y) for p, mass in zip(places, masses, strict=True)]
    return tuple(found)


def _with(scene: Scene, weights: Sequence[Counterweight]) -> Scene:
    """The scene with its counterweights as additional bodies."""
    bodies = dict(scene.bodies)
    for weight in weights:
        stem = name = f"{weight.link}_counterweight"
        count = 1
        while name in bodies:
            count += 1
            name = f"{stem}_{count}"
        bodies[name] = Body(link=weight.link, mass=weight.mass, x=weight.x, y=weight.y)
    return scene.model_copy(update={"bodies": bodies})
