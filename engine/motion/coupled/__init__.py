"""Motion at two speeds: a shaft that a coupling holds to the crank, or lets slip."""
