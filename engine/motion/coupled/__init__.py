"""Motion at two speeds: a coupling locks a shaft to the crank or lets it slip."""
