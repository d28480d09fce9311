"""Points of rigid links: each link has axes, with an origin and the direction (cos, sin) of its x axis."""

from engine.compiling.decorators import scalar


@scalar
def arm(along: float, across: float, c: float, s: float) -> tuple[float, float]:
    """Vector, in frame axes [m], from a link's origin to its point (along, across).

    Parameters
    ----------
    along, across : float
        Coordinates in the link's axes, x along the link and y to its left [m].
    c, s : float
        Cosine and sine of the link's angle.
    """
    return along * c - across * s, along * s + across * c
