"""The language of formulas: expressions, their names, dimensions and switches."""
