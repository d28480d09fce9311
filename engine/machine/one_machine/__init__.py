"""One machine looked at closely: at positions of its input, and instant by instant through its regimes."""
