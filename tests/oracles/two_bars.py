"""Two bars between two driven points: where they meet, and what power they take, in the digits of mpmath."""

from collections.abc import Callable

import mpmath

# Masses and inertias of both bars and of the second driven link.
BODIES = [(0.7, 0.002), (0.8, 0.003), (1.5, 0.002)]


def joint(one: mpmath.mpc, other: mpmath.mpc, left: float, right: float) -> mpmath.mpc:
    """Where both bars meet, to the left of the line from one end to the other."""
    line = other - one
    near = (abs(line) ** 2 + mpmath.mpf(left) ** 2 - mpmath.mpf(right) ** 2) / (2 * abs(line))
    return one + line / abs(line) * mpmath.mpc(near, mpmath.sqrt(mpmath.mpf(left) ** 2 - near**2))


def power(ends: Callable, left: float, right: float, time: mpmath.mpf, ram: float = 0.0) -> mpmath.mpf:
    """Power that changes the energy, from positions over time alone; `ends` gives both and the second's direction."""

    def parts(t: mpmath.mpf) -> list[tuple[mpmath.mpc, mpmath.mpc]]:
        one, other, turned = ends(t)
        inner = joint(one, other, left, right)
        fore, aft = (inner - one) / mpmath.mpf(left), (inner - other) / mpmath.mpf(right)
        return [(one + 0.09 * fore, fore), (other + 0.08 * aft, aft), (other, turned)]

    def energy(t: mpmath.mpf) -> mpmath.mpf:
        total = ram * 9.81 * ends(t)[0].imag
        for i, (mass, inertia) in enumerate(BODIES):
            centre, direction = (mpmath.diff(lambda x, i=i, k=k: parts(x)[i][k], t) for k in (0, 1))
            total += mass * abs(centre) ** 2 / 2 + inertia * abs(direction) ** 2 / 2
            total += mass * 9.81 * parts(t)[i][0].imag
        return total

    return mpmath.diff(energy, time)
