"""Lines that find the flywheel sizes of several variants of one shape side by side, each in a lane of its own.

I and W at a position are sums over the loads. What the loads that don't vary contribute is summed once for the
shape; a lane adds its own loads to that. What is kept of a lane is in `engine.equal_positions.lanes`.
"""

from typing import NamedTuple

from engine.equal_positions.text.demand import HALF

Terms = list[tuple[str, str]]
ONE = "one"


class SideBySide(NamedTuple):
    """Lines about several variants at once.

    Attributes
    ----------
    shape : tuple of str
        For the shape: rows of the loads that don't vary.
    loads : tuple of str
        Loads of which each lane keeps its own.
    begin : str
        For each lane, before the cycle.
    shared : tuple of str
        For each pair of positions k and k + 1: the numbers that all lanes share.
    lane : tuple of str
        For each pair of positions and each lane.
    """

    shape: tuple[str, ...]
    loads: tuple[str, ...]
    begin: str
    shared: tuple[str, ...]
    lane: tuple[str, ...]

    @property
    def text(self) -> str:
        """All of it, to be searched for names."""
        return "\n".join((*self.shape, *self.loads, self.begin, *self.shared, *self.lane))


class _Sum:
    """A row as the sum of load × row: those of the loads that vary, and one row of all that don't."""

    def __init__(self, terms: Terms, fixed: frozenset[str], row: str) -> None:
        self.own = [t for t in terms if t[0] not in fixed]
        self.rest = [t for t in terms if t[0] in fixed]
        self.row = row

    def rows(self) -> list[str]:
        """Rows that a lane's numbers are made from."""
        return [self.row] * bool(self.rest) + [r for _, r in self.own if r != ONE]

    def rest_lines(self, mark: str = "") -> list[str]:
        """What fills the row of the loads that don't vary."""
        if not self.rest:
            return []
        total = added(self.rest, f"{{}}{mark}[k]")
        return [f"for k in range({self.row}{mark}.shape[0]):", f"    {self.row}{mark}[k] = {total}"]

    def end(self, place: str) -> str:
        """Its value at a place of the cycle."""
        rest = [f"{self.row}[{place}]"] * bool(self.rest)
        return " + ".join(rest + [added(self.own, f"{{}}[{place}]")] * bool(self.own)) or "zero"

    def of_lane(self, when: str, mark: str = "") -> str:
        """Its value in a lane from the numbers that all lanes share."""
        rest = [f"{when}__{self.row}{mark}"] * bool(self.rest)
        own = [(f"lane__{c}[lane]", r) for c, r in self.own]
        return " + ".join(rest + [added(own, f"{when}__{{}}{mark}")] * bool(own)) or "zero"


def added(terms: Terms, row: str) -> str:
    """Sum of load × row as text, `row` saying how a row is called; the row "one" leaves the load alone."""
    return " + ".join(c if r == ONE else f"{c} * {row.format(r)}" for c, r in terms) or "zero"


def side_by_side(inertia: Terms, work: Terms, fixed: frozenset[str], sizes: str) -> SideBySide:
    """Write what it takes to find the extremes of I and W of several variants.

    Parameters
    ----------
    inertia, work : list of (str, str)
        Loads and rows whose products add up to I and W.
    fixed : frozenset of str
        Loads that are the same for all variants.
    sizes : str
        The last arguments of `flywheel_sizes`: mean speed, coefficient of speed fluctuation, constant inertia.
    """
    # Names of a scene hold no two underscores in a row, so no variable has such a row.
    i, w = _Sum(inertia, fixed, "bas__fixed__loads"), _Sum(work, fixed, "wrk__fixed__loads")
    omega, delta, _ = sizes.split(", ")
    ends = ", ".join(f"{w.end(place)}, {i.end(place)}" for place in ("n - 2", "n - 1"))
    shared = [f"here__{r}, after__{r} = {r}[k], {r}[k + 1]" for r in (*i.rows(), *w.rows())]
    shared += [f"here__{r}{HALF} = {r}{HALF}[k // 2]" for r in w.rows()]
    lane = (
        f"work, work_half, work_after = {w.of_lane('here')}, {w.of_lane('here', HALF)}, {w.of_lane('after')}",
        f"inertia, inertia_after = {i.of_lane('here')}, {i.of_lane('after')}",
        "two_positions(kept, lane, work, inertia, work_after, inertia_after, work_half)",
    )
    return SideBySide(
        (*i.rest_lines(), *w.rest_lines(), *w.rest_lines(HALF)),
        tuple(dict.fromkeys(c for c, _ in (*i.own, *w.own))),
        f"begin_cycle(kept, lane, {omega}, {delta}, {ends})",
        tuple(dict.fromkeys(shared)),
        lane,
    )
