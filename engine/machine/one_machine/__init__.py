"""One machine in detail: at positions of its input, and over time through its regimes."""
