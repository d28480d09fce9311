"""Harmonics of the law by which a second drive follows the first."""

from engine.compiling.decorators import scalar
from engine.laws.elementary import direction_of


@scalar
def law_harmonic(angle: float, order: float, cosine: float, sine: float) -> tuple[float, float, float]:
    """Contribution of a harmonic c cos kφ + s sin kφ to an angle [rad] or a position [m], and to its derivatives by φ.

    Parameters
    ----------
    angle : float
        φ [rad].
    order : float
        Order k.
    cosine, sine : float
        Amplitudes c and s [rad or m].
    """
    c, s = direction_of(order * angle)
    added = cosine * c + sine * s
    return added, order * (sine * c - cosine * s), -(order * order) * added
