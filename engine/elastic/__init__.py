"""Elastic links: vibration of one mass, compliance of drives, torsional trains, transients of elastic drives."""
