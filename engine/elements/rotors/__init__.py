"""Rigid rotors: unbalance, correction, grades, trial runs, balancing machines."""
