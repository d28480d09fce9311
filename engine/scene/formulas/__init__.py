"""Formulas in texts: arithmetic with units, read safely, its dimensions checked; and the formulas of loads."""
