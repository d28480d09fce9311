"""Numbers of an element."""

from collections.abc import Mapping

import numpy as np

# By their keys, (variants,) each, in SI units.
Numbers = Mapping[str, np.ndarray]
