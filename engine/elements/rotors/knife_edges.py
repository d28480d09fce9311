"""Static balancing on knife edges: the unbalance that rolling friction hides.

The rotor rolls until its heavy side is at the bottom. It stays where the moment of its unbalance, D g sin(theta), does
not exceed that of rolling friction, m g k: for D below m k it rests in any position, above that within theta =
arcsin(m k/D) of the lowest position of the heavy side. A couple has no effect.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (static unbalance of a rotor).
"""

import numpy as np

from engine.elements.element import NamedRows, Numbers
from engine.words.quantity import main_result


def knife_edge_results(unbalance: np.ndarray, n: Numbers) -> NamedRows:
    """Results on knife edges, for a rotor with a `mass` and a `rolling_arm`, and the magnitude of its unbalance."""
    if "rolling_arm" in n:
        residual, words = n["mass"] * n["rolling_arm"], "unbalance that rolling friction on knife edges leaves"
        yield main_result("knife_edge_unbalance", words, "kg m"), residual
        words = "maximum angle between the heavy side and the lowest position at rest on knife edges"
        angle = np.where(residual >= unbalance, np.pi, np.arcsin(np.minimum(residual / unbalance, 1.0)))
        yield main_result("knife_edge_angle", words, "rad"), angle
