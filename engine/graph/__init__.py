"""A machine's mathematics as a graph of typed nodes, and the functions that are printed from it and compiled."""
