"""Runs: motion from a given state to an angle, a time, a speed, or rest."""
