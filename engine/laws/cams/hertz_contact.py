"""Hertz's contact pressure.

Source: K. L. Johnson, Contact Mechanics, chapter 4.
"""

import math

import numpy as np


def pressure_of_lines(curved_force: np.ndarray, modulus: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Maximum Hertzian pressure between cylinders of one material in line contact [Pa].

    Parameters
    ----------
    curved_force : ndarray
        Normal force times the sum of the curvatures, negative for hollow ones [N/m].
    modulus : ndarray
        E/(2(1 − ν²)) of the material [Pa].
    width : ndarray
        Length of the contact line [m].
    """
    return np.sqrt(curved_force * modulus / (math.pi * width))
