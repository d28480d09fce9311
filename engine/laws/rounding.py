"""Rounding of float64."""

# Machine epsilon: distance from 1 to the next float64.
EPS = 2.0**-52
# Relative perturbation by which sensitivity to rounding is measured: half of the digits remain for the change.
NUDGE = 2.0**-26
