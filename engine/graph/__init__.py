"""A machine's equations as a graph of typed nodes, and the functions printed from it and compiled."""
