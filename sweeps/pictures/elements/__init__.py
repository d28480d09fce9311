"""Plots of machine elements: rotors, engines, governors, springs, gears, cams."""
