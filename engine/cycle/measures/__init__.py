"""What is asked of curves over the whole cycle: extremes, works, speeds, angles, averages, arcs without load."""
