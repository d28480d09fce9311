"""What Python and its notebooks get beside the engine: datasets, figures, and how things show themselves."""
