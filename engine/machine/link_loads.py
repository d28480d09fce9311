"""What acts on a link: forces and moments summed about its origin, as variables of a program."""

from typing import NamedTuple

from engine.machine.mechanism import Moving


class Force(NamedTuple):
    """Variables of a force and its moment about the origin of the link it acts on."""

    x: str
    y: str
    m: str


class Load:
    """What acts on a link, in terms of sums: a force and its moment about the link's origin."""

    def __init__(self, terms: Force | None = None) -> None:
        self.x, self.y, self.m = ([term] for term in terms) if terms else ([], [], [])

    def push(self, origin: Moving, at: Moving, fx: str, fy: str) -> None:
        """Add a force at a point."""
        if fx == fy == "zero":
            return
        self.x.append(fx)
        self.y.append(fy)
        if at != origin:
            px, py = (a if o == "zero" else f"{a} - {o}" for a, o in ((at.x, origin.x), (at.y, origin.y)))
            self.m.append(f"moment_of({px}, {py}, {fx}, {fy})")
