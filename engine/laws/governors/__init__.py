"""Laws of speed governors: how balls and sleeve move together, what holds the balls, stability with an engine."""
