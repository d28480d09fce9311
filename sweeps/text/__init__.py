"""Texts: TOML and its errors, CSV tables, expressions with their dimensions, and numbers as engineers read them."""
