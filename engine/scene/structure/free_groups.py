"""Structural groups that free links make up, of any class, and how their loops are cut.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on the classification of mechanisms.
"""

from itertools import combinations
from typing import NamedTuple

from engine.scene.pairs import Pair


class FreeGroup(NamedTuple):
    """A structural group of free links.

    Attributes
    ----------
    name : str
        `group_of_LINK`, that of its link with the most pairs.
    links : tuple of str
    pairs : tuple of Pair
        Its own, inner and outer ones.
    """

    name: str
    links: tuple[str, ...]
    pairs: tuple[Pair, ...]

    @property
    def order(self) -> int:
        """How many pairs join it to other links."""
        return sum(not {pair.link, pair.other} <= set(self.links) for pair in self.pairs)

    @property
    def group_class(self) -> int:
        """Its class: 2 for a dyad, otherwise the number of sides of its largest closed contour.

        A link with three or more pairs is such a contour, and so is a loop of links.
        """
        if len(self.links) == 2:
            return 2
        most = max(len(self.pairs_of(link)) for link in self.links)
        return max(most, self._longest_loop())

    def pairs_of(self, link: str) -> list[Pair]:
        """The pairs of one of its links."""
        return [pair for pair in self.pairs if link in (pair.link, pair.other)]

    def _longest_loop(self) -> int:
        beside: dict[str, list[str]] = {link: [] for link in self.links}
        for pair in self.pairs:
            if pair.link in beside and pair.other in beside:
                beside[pair.link].append(pair.other)
                beside[pair.other].append(pair.link)
        longest, paths = 0, [[link] for link in self.links]
        while paths:
            path = paths.pop()
            for link in beside[path[-1]]:
                if link == path[0] and len(path) > 2:
                    longest = max(longest, len(path))
                elif link not in path:
                    paths.append([*path, link])
        return longest


class Cutting(NamedTuple):
    """How the loops of a group are cut.

    Attributes
    ----------
    placed : tuple of (str, Pair)
        Links with the pair by which each hangs on what is known or was placed before it: one unknown each.
    cut_links : tuple of str
        Links with two pairs, each between two others: one equation each.
    cut_pairs : tuple of Pair
        Pairs that close the loops that are left: two equations each.
    """

    placed: tuple[tuple[str, Pair], ...]
    cut_links: tuple[str, ...]
    cut_pairs: tuple[Pair, ...]


def cutting_of(group: FreeGroup) -> Cutting:
    """The way to cut a group with the fewest unknowns: as many links cut out of its loops as can be.

    Prismatic pairs are cut last: across them links keep their direction, which leaves fewer angles to be found.
    """
    two = [link for link in group.links if _can_be_cut(group, link)]
    for count in range(min(len(two), len(group.links) // 2), -1, -1):
        for cut in combinations(two, count):
            placed = _spanned(group, cut)
            if placed is not None:
                used = {id(pair) for _, pair in placed}
                used |= {id(pair) for link in cut for pair in group.pairs_of(link)}
                return Cutting(tuple(placed), cut, tuple(p for p in group.pairs if id(p) not in used))
    raise AssertionError("a group without any link cut out always hangs together")


def _can_be_cut(group: FreeGroup, link: str) -> bool:
    kinds = [pair.kind for pair in group.pairs_of(link)]
    return len(kinds) == 2 and "revolute" in kinds


def _spanned(group: FreeGroup, cut: tuple[str, ...]) -> list[tuple[str, Pair]] | None:
    """Links but those cut, in an order in which each hangs on one before it; None where that can't be."""
    left = [link for link in group.links if link not in cut]
    pairs = [p for p in group.pairs if p.link not in cut and p.other not in cut]
    pairs.sort(key=lambda pair: pair.kind != "prismatic")
    found: list[tuple[str, Pair]] = []
    while left:
        sides = [side for p in pairs for side in ((p.link, p.other, p), (p.other, p.link, p))]
        ready = [(link, pair) for link, other, pair in sides if link in left and other not in left]
        if not ready:
            return None
        found.append(ready[0])
        left.remove(ready[0][0])
    return found
