"""Runs: motion from a given state until an angle, a time, a speed, or rest."""
