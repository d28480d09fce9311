"""Mechanisms found from what is wanted of them: quick returns by their time ratio, dyads through given positions."""
