"""Error of synthesis."""

from engine import UserError


class SynthesisError(UserError, ValueError):
    """No mechanism meets the requirements; the message names the number to change."""
