"""Friction of the pairs of a machine: slides, journals, screws, wedges, rollers and belts, as scalar functions."""
