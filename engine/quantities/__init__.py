"""The register of quantities: each declared once, with its name, unit, words, and what it is computed from."""
