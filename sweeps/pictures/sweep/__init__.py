"""Plots of sweeps and searches: curves, maps, scatters, parallel coordinates, fronts."""
