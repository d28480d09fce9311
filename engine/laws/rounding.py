"""Rounding of float64."""

# Distance from 1 to the next number.
EPS = 2.0**-52
# A share by which a number is moved to see what a result owes to its rounding: half the digits are left for the change.
NUDGE = 2.0**-26
