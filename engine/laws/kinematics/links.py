"""Points of rigid links: a link has its own axes, with an origin and the direction (cos, sin) of its x axis."""

from engine.compiling.decorators import scalar


@scalar
def arm(along: float, across: float, c: float, s: float) -> tuple[float, float]:
    """Vector from the link's origin to the point (along, across) of the link's own axes, in frame axes.

    Parameters
    ----------
    along, across : float
        Coordinates in the link's axes, x along the link and y to its left [m].
    c, s : float
        Cosine and sine of the link's angle.
    """
    return along * c - across * s, along * s + across * c
