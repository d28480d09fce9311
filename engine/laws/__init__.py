"""The ground floor: scalar functions that read like the textbook's equations."""
