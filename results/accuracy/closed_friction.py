"""Friction in all pairs, settled by passes, on the closed formulas of `closed_forces`, in extended precision.

The reactions of a group are linear in its loads, friction is so in the pressing forces n, and a pressing force is the
length of a reaction (of a guide the greater of |N| and |M|/a). Two ways of passing from old n to new ones:

- solved: the directions of the reactions are taken from the old n, the n that then belong to them solved exactly;
- substituted: friction is taken from the old n, and n from the reactions with it.

Groups are settled one after another, last first. All is in 80 bits, position by position.
"""

from typing import NamedTuple

import numpy as np
from closed_cycle import TURN, stroke_ends
from closed_forces import Dynamics, Where, Wrench
from closed_motion import Motion, Numbers, Place, numbers_of
from taylor import EXTENDED, Series

from engine import Scene
from engine.scene.pairs import Pair, pairs_of_group

GRID = 721
# Passes end where no pressing force changes by more than this share. Whole steps first, then half ones.
LEAST_CHANGE, WHOLE_PASSES = 1e-18, 8
# Components of a reaction: x and y, or normal force and moment.
Parts = tuple[np.ndarray, np.ndarray]


class Rub(NamedTuple):
    """Friction in a pair: on its link and on the other one for each newton that presses, and the work it takes.

    `edge` is of a guide, 2 over the slider's length, 0 where it has none.
    """

    pair: Pair
    on: Wrench
    lost: np.ndarray
    edge: np.longdouble | None


class Settled(NamedTuple):
    """What friction does: reactions by pair, work lost for each radian, least determinant of friction's feedback.

    `change` is the greatest change of a pressing force in the last pass, as a share.
    """

    reactions: dict[str, Parts]
    lost: np.ndarray
    margin: float
    change: float


class Rubbed(Dynamics):
    """A machine whose pairs rub, at equally spaced angles."""

    def __init__(self, scene: Scene, varied: dict[str, float], positions: int) -> None:
        numbers = numbers_of(scene, varied, EXTENDED)

        def motion(angles: np.ndarray) -> Motion:
            return Motion(scene, numbers, angles, 2, EXTENDED)

        here = motion(TURN * np.arange(positions) / positions)
        ends, _ = stroke_ends(motion, here.slides, np.longdouble(0.1234567) + TURN * np.arange(GRID) / (GRID - 1))
        super().__init__(scene, numbers, Where(here, here), ends)
        named = {friction.pair: name for name, friction in scene.friction.items()}
        self.rubs = {
            pair.name: self._rub(pair, f"friction.{named[pair.name]}", numbers)
            for group in scene.groups
            for pair in pairs_of_group(scene, group)
        }
        self.backs = {
            group: [self._solved(group, *self._loads_of(group, pair)) for pair in pairs_of_group(scene, group)]
            for group in scene.groups
        }

    def _reactions(self) -> None:
        """None but the settled ones."""

    def _rub(self, pair: Pair, at: str, numbers: Numbers) -> Rub:
        link, other = (self.motion.links[name] for name in (pair.link, pair.other))
        f, zero = numbers[f"{at}.coefficient"], self.motion.zero
        if pair.kind == "revolute":
            rate, arm = (link.rate - other.rate)[0], numbers[f"{at}.diameter"] / 2 * f / np.sqrt(1 + f * f)
            drag = -np.sign(rate * numbers["input.speed"]) * arm
            return Rub(pair, Wrench(Place(zero, zero), zero + drag), abs(rate) * arm, None)
        # The slider's origin against the place of the other link that it is at.
        carried = other.origin.by_angle() + (link.origin - other.origin).left.times(other.rate)
        rate = (link.origin.by_angle() - carried).along(link.way)[0]
        force = link.way.times(zero + -np.sign(rate * numbers["input.speed"]) * f)
        length = numbers.get(f"{at}.length")
        edge = np.longdouble(0) if length is None else 2 / length
        return Rub(pair, Wrench(force, link.origin.across(force)), abs(rate) * f, edge)

    def settle(self, passes: int, substituted: bool = False) -> Settled:
        """Reactions after so many passes in every group; passes end before where nothing changes any more."""
        totals = {link: list(wrenches) for link, wrenches in self.totals.items()}
        reactions, lost, margins, changes = {}, 0 * self.motion.angles, [1.0], [0.0]
        for name in reversed(self.scene.groups):
            around = pairs_of_group(self.scene, name)
            group = self.scene.groups[name]
            loads = [_sum(totals[side.link], self.motion.zero) for side in (group.first, group.second)]
            free = self._solved(name, *loads)
            feedback = Feedback([self.rubs[pair.name].edge for pair in around], free, self.backs[name])
            n, margin, change = feedback.settled(passes, substituted)
            found = feedback.reactions(n)
            reactions |= {pair.name: parts for pair, parts in zip(around, found, strict=True)}
            for pair, parts, pressing in zip(around, found, n, strict=True):
                lost = lost + self.rubs[pair.name].lost * pressing
                if not pair.name.endswith(".inner"):
                    totals[pair.other].append(self._borne(pair, parts, pressing))
            margins.append(margin)
            changes.append(change)
        load = _sum(totals[self.scene.input.link], self.motion.zero).force
        reactions["input"] = (-load.x[0], -load.y[0])
        return Settled(reactions, lost, min(margins), max(changes))

    def _borne(self, pair: Pair, parts: Parts, pressing: np.ndarray) -> Wrench:
        """What carries an outer pair bears: the opposite of its reaction and of its friction."""
        link, zero, rub = self.motion.links[pair.link], self.motion.zero, self.rubs[pair.name].on
        a, b = (zero + part for part in parts)
        force, own = (Place(a, b), zero) if pair.kind == "revolute" else (link.way.left.times(a), b)
        total = Wrench(force, link.origin.across(force) + own) + _times(rub, zero + pressing)
        return _times(total, -1)

    def _loads_of(self, group: str, pair: Pair) -> tuple[Wrench, Wrench]:
        """Loads on both links of a group by friction in one of its pairs, for each newton that presses."""
        own, none = self.rubs[pair.name].on, _times(self.rubs[pair.name].on, 0)
        if pair.name.endswith(".inner"):
            return own, _times(own, -1)
        return (own, none) if pair.link == self.scene.groups[group].first.link else (none, own)

    def _solved(self, name: str, one: Wrench, two: Wrench) -> list[Parts]:
        """Reactions of a group under loads on its links: of the first, the inner, the second pair."""
        group = self.scene.groups[name]
        inner = {"RRR": self._rrr, "RRP": self._rrp, "RPR": self._rpr, "RPP": self._rpp}[group.type](group, one, two)
        link, other = self.motion.links[group.first.link], self.motion.links[group.second.link]
        first = Place(-one.force.x - inner.x, -one.force.y - inner.y)
        rest, twist = inner - two.force, -one.about(link.origin)
        turns = group.type in ("RRR", "RRP")
        middle = (inner.x, inner.y) if turns else (inner.along(link.way.left), twist)
        if group.type in ("RRR", "RPR"):
            last = (rest.x, rest.y)
        elif group.type == "RRP":
            last = (rest.along(other.way.left), -two.about(other.origin))
        else:
            arm = link.origin - other.origin
            last = (rest.along(other.way.left), arm.across(inner) + twist - two.about(other.origin))
        return [(x[0], y[0]) for x, y in ((first.x, first.y), middle, last)]


class Feedback:
    """Friction of the three pairs of a group that acts back on the reactions it comes from.

    Parameters
    ----------
    edges : list of number or None
        Of each pair that is a guide: 2 over the slider's length, 0 where it never tilts.
    free : list of Parts
        Reaction of each pair without friction in the group.
    backs : list of list of Parts
        [j][i]: what a newton that presses in pair j adds to the reaction of pair i.
    """

    def __init__(self, edges: list, free: list[Parts], backs: list[list[Parts]]) -> None:
        self.edges, self.free, self.backs = edges, np.array(free), np.array(backs)

    def reactions(self, n: np.ndarray) -> np.ndarray:
        """Reactions with friction, (pairs, 2, positions)."""
        return self.free + (self.backs * n[:, None, None]).sum(axis=0)

    def settled(self, passes: int, substituted: bool) -> tuple[np.ndarray, float, float]:
        """Pressing forces (pairs, positions), least determinant, change in the last pass."""
        n, margin, change = 0 * self.free[:, 0], 1.0, 0.0
        for k in range(passes):
            bearing = self._bearing(self.reactions(n))
            if substituted:
                new = (bearing * self.reactions(n)).sum(axis=1)
            else:
                new, determinant = self._exact(bearing)
                # Half steps end a to and fro over a kink.
                new, margin = (new if k < WHOLE_PASSES else (new + n) / 2), float(determinant.min())
            change = float((abs(new - n).sum(axis=0) / abs(new).sum(axis=0)).max())
            n = new
            if not change > LEAST_CHANGE:
                break
        return n, margin, change

    def _bearing(self, reactions: np.ndarray) -> np.ndarray:
        """Factors of both components of each reaction that give its pressing force."""
        found = np.zeros_like(reactions)
        for (x, y), edge, factors in zip(reactions, self.edges, found, strict=True):
            if edge is None:
                factors[:] = np.stack([x, y]) / np.hypot(x, y)
            else:
                tilts = abs(y) * edge > abs(x)
                factors[:] = np.where(tilts, 0, np.sign(x)), np.where(tilts, edge * np.sign(y), 0)
        return found

    def _exact(self, bearing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressing forces where reactions have known directions, by Cramer's rule, and the determinant."""
        back = (bearing * self.backs).sum(axis=2)
        a, b, c = np.eye(3, dtype=np.longdouble)[:, :, None] - back
        given = (bearing * self.free).sum(axis=1)
        crossed = [np.cross(p, q, axis=0) for p, q in ((b, c), (c, a), (a, b))]
        determinant = (a * crossed[0]).sum(axis=0)
        return np.stack([(given * normal).sum(axis=0) for normal in crossed]) / determinant, determinant


def _sum(wrenches: list[Wrench], zero: Series) -> Wrench:
    return sum(wrenches, Wrench(Place(zero, zero), zero))


def _times(wrench: Wrench, factor: object) -> Wrench:
    return Wrench(Place(wrench.force.x * factor, wrench.force.y * factor), wrench.moment * factor)
