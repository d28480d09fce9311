"""Balancing of rotors and engines: unbalance, correction, grades, trial runs, balancing machines, orders, shafts."""
