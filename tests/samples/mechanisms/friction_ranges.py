"""Ranges of the numbers of friction that its tests draw from."""

from hypothesis import settings
from hypothesis import strategies as st

sizes = st.floats(-4.0, 4.0).map(lambda exponent: 10.0**exponent)
frictions = st.floats(1e-6, 1.2)
slopes = st.floats(1e-6, 3.0)
# Subnormal numbers have no digits to compare.
loads = st.floats(-1e3, 1e3).filter(lambda load: load == 0.0 or abs(load) > 1e-250)
quick = settings(max_examples=60)
