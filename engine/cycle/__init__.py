"""The cycle: from the curves of a machine to numbers with error figures, by code compiled once for all machines."""
