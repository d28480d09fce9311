"""Transients of a drive with an elastic shaft and backlash: starts, sudden loads, impacts."""
