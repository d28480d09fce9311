"""From a machine's curves to results over its cycle, with error estimates, by code compiled once for all machines."""
