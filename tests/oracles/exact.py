"""References from exact pieces: values of cubics, tops of close values."""

import numpy as np

EPS = np.finfo(float).eps


def table_value(table, x):
    """Value of a piecewise cubic `Table` at x; at a step the value after it, NaN for NaN."""
    u = np.asarray(x, float)
    if table.period:
        outside = (u < table.start) | (u >= table.start + table.period)
        u = np.where(outside, table.start + (u - table.start) % table.period, u)
    piece = np.clip(np.searchsorted(table.breaks, u, side="right") - 1, 0, len(table.coefficients) - 1)
    c3, c2, c1, c0 = np.moveaxis(table.coefficients[piece], -1, 0)
    t = u - table.breaks[piece]
    return ((c3 * t + c2) * t + c1) * t + c0


def top_between(row):
    """Greatest value of the quartic through the highest of equally spaced values of a cycle and two on either side."""
    places = np.arange(-2, 3)
    quartic = np.polynomial.Polynomial.fit(places, np.roll(row, 2 - row.argmax())[:5], 4)
    tops = quartic.deriv().roots()
    return quartic(tops[np.argmin(abs(tops))].real)
