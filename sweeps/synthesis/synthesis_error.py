"""Error of synthesis."""


class SynthesisError(ValueError):
    """No mechanism meets the requirements; the message names the number to change."""
