"""A machine on an elastic shaft, under a governor, or exciting a torsional train."""
