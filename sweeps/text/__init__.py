"""Texts: TOML with errors, CSV tables, expressions with dimensions, numbers in practical units."""
