"""Fields along a recorded motion: speeds, torques, powers and loads on the pairs, their statistics and instants."""
