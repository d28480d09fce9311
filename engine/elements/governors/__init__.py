"""Speed governors: characteristics, stability with the engine they govern, and what a change of load does."""
