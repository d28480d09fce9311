"""Standard sizes of parts: preferred numbers for lengths and diameters, rated powers of motors.

The series R5, R10, R20 and R40 divide a decade into 5, 10, 20 and 40 equal ratios and round the numbers, by −1.01 % to
+1.26 %; each holds every second number of the next. Source: the basic series of ISO 3:1973, compared with several
printed tables. Motors: rated outputs of IEC 60072-1 that European catalogues list, thus 3 and 4 kW without 3.7 kW.
"""

import math
from decimal import Decimal
from typing import NamedTuple

_R40 = """
1.00 1.06 1.12 1.18 1.25 1.32 1.40 1.50 1.60 1.70 1.80 1.90 2.00 2.12 2.24 2.36 2.50 2.65 2.80 3.00
3.15 3.35 3.55 3.75 4.00 4.25 4.50 4.75 5.00 5.30 5.60 6.00 6.30 6.70 7.10 7.50 8.00 8.50 9.00 9.50
"""
_IEC = """
0.06 0.09 0.12 0.18 0.25 0.37 0.55 0.75 1.1 1.5 2.2 3 4 5.5 7.5 11 15 18.5 22 30 37 45 55 75 90 110 132 160 200 250
315 355 400 450 500 560 630 710 800 900 1000
"""


class StandardSizes(NamedTuple):
    """A series of standard sizes.

    Attributes
    ----------
    dimension : str
        A key of `DIMENSIONS`.
    unit : Decimal
        The numbers' unit in SI.
    numbers : tuple of Decimal
        In ascending order.
    every_decade : bool
        Whether they repeat in every decade.
    """

    dimension: str
    unit: Decimal
    numbers: tuple[Decimal, ...]
    every_decade: bool

    def between(self, low: float, high: float) -> list[float]:
        """Sizes from `low` to `high` in SI, both above 0 and inclusive."""
        return [size for size in self._in_decades_of(low, high) if low <= size <= high]

    def around(self, low: float, high: float) -> list[float]:
        """The next size below `low` and the next above `high`, those that exist."""
        sizes = self._in_decades_of(low, high)
        return [size for size in sizes if size < low][-1:] + [size for size in sizes if size > high][:1]

    def _in_decades_of(self, low: float, high: float) -> list[float]:
        """All sizes in the decades of a range and one more at either end."""
        first, last = 0, 0
        if self.every_decade:
            first, last = (math.floor(math.log10(end) - math.log10(self.unit)) for end in (low, high))
            first, last = first - 1, last + 1
        decades = range(first, last + 1)
        return [float(number.scaleb(decade) * self.unit) for decade in decades for number in self.numbers]


def _preferred(step: int) -> StandardSizes:
    """Preferred numbers in mm: every `step`th number of R40."""
    return StandardSizes("length", Decimal("0.001"), tuple(map(Decimal, _R40.split()[::step])), True)


STANDARD_SIZES = {
    "R5": _preferred(8),
    "R10": _preferred(4),
    "R20": _preferred(2),
    "R40": _preferred(1),
    "IEC": StandardSizes("power", Decimal(1000), tuple(map(Decimal, _IEC.split())), False),
}
