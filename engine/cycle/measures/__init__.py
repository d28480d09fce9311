"""Results of curves over the whole cycle: extremes, work, speeds, angles, averages, unloaded arcs."""
