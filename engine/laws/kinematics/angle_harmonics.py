"""Harmonics of the angle by which a second drive follows the first."""

from engine.compiling.decorators import scalar
from engine.laws.elementary import direction_of


@scalar
def angle_harmonic(angle: float, order: float, cosine: float, sine: float) -> tuple[float, float, float]:
    """What a harmonic c cos kφ + s sin kφ adds to an angle [rad], and to its first two derivatives by φ.

    Parameters
    ----------
    angle : float
        φ [rad].
    order : float
        Its number k.
    cosine, sine : float
        Its amplitudes c and s [rad].
    """
    c, s = direction_of(order * angle)
    added = cosine * c + sine * s
    return added, order * (sine * c - cosine * s), -(order * order) * added
