"""Studies: text, variables, sampling, outputs and search."""
