"""Structural groups of free links, of any class, and how their loops are cut.

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
        `group_of_LINK`, after its link with the most pairs.
    links : tuple of str
    pairs : tuple of Pair
        Inner and outer pairs.
    """

    name: str
    links: tuple[str, ...]
    pairs: tuple[Pair, ...]

    @property
    def order(self) -> int:
        """Number of outer pairs."""
        return sum(not {pair.link, pair.other} <= set(self.links) for pair in self.pairs)

    @property
    def group_class(self) -> int:
        """Class: 2 for a dyad, else the number of sides of the largest closed contour.

        A contour is a link with three or more pairs, or a loop of links.
        """
        if len(self.links) == 2:
            return 2
        most = max(len(self.pairs_of(link)) for link in self.links)
        return max(most, self._longest_loop())

    def pairs_of(self, link: str) -> list[Pair]:
        """The pairs of one of its links."""
        return [pair for pair in self.pairs if link in (pair.link, pair.other)]

    def _longest_loop(self) -> int:
        neighbours: dict[str, list[str]] = {link: [] for link in self.links}
        for pair in self.pairs:
            if pair.link in neighbours and pair.other in neighbours:
                neighbours[pair.link].append(pair.other)
                neighbours[pair.other].append(pair.link)
        longest, paths = 0, [[link] for link in self.links]
        while paths:
            path = paths.pop()
            for link in neighbours[path[-1]]:
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
        Placed links, each with the pair that attaches it to a known link or to one placed before it: one unknown each.
    cut_links : tuple of str
        Links with two pairs, each between two other links: one equation each.
    cut_pairs : tuple of Pair
        Pairs that close the remaining loops: two equations each.
    """

    placed: tuple[tuple[str, Pair], ...]
    cut_links: tuple[str, ...]
    cut_pairs: tuple[Pair, ...]


def cutting_of(group: FreeGroup) -> Cutting:
    """Cut a group so that the fewest unknowns remain: as many links as possible are cut out of its loops.

    Prismatic pairs are cut last: links connected by one keep their relative direction, which saves angles as unknowns.
    """
    two = [link for link in group.links if _can_be_cut(group, link)]
    for count in range(min(len(two), len(group.links) // 2), -1, -1):
        for cut in combinations(two, count):
            placed = _spanned(group, cut)
            if placed is not None:
                used = {id(pair) for _, pair in placed}
                used |= {id(pair) for link in cut for pair in group.pairs_of(link)}
                return Cutting(tuple(placed), cut, tuple(p for p in group.pairs if id(p) not in used))
    raise AssertionError("a group without any link cut out is always connected")


def _can_be_cut(group: FreeGroup, link: str) -> bool:
    kinds = [pair.kind for pair in group.pairs_of(link)]
    return len(kinds) == 2 and "revolute" in kinds


def _spanned(group: FreeGroup, cut: tuple[str, ...]) -> list[tuple[str, Pair]] | None:
    """Order the links not cut so that each is attached to an earlier one; None if that is impossible."""
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
