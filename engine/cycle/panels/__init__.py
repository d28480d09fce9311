"""Panels: the intervals a cycle is divided into, the series of curves on them, and the record of these."""
