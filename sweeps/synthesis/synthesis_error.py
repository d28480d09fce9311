"""What is said where no mechanism does what is wanted."""


class SynthesisError(ValueError):
    """No mechanism does what is wanted, or what is wanted makes no sense; the message says which number to change."""
