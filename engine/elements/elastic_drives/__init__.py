"""Drives with an elastic shaft and backlash: starts, sudden loads, impacts, steady running."""
