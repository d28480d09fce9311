"""Engines for tests: any cylinders at any angles."""

import math

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from engine.elements.engines.engine_layout import Engine, EngineLayout

EPS = np.finfo(float).eps
RIGHT = math.pi / 2
ALL = tuple(range(1, 25))

few = settings(max_examples=25)
angles = st.floats(-6.0, 6.0)


@st.composite
def engines(draw):
    count = draw(st.integers(1, 5))
    rows = draw(st.lists(st.tuples(angles, angles, st.floats(-1, 1)), min_size=count, max_size=count))
    banks, throws, positions = np.array(rows).T
    masses = np.array(draw(st.lists(st.floats(0.1, 2.0), min_size=count, max_size=count)))
    radius = draw(st.floats(0.01, 1.0))
    rod = radius / draw(st.floats(0.05, 0.4))
    offset = rod * draw(st.floats(-0.15, 0.15))
    return Engine(EngineLayout(banks, throws, positions), radius, rod, masses, draw(st.floats(0, 1)), offset)
