"""Which answers are shown, why there is none, and how they changed."""
