"""Warnings on machines that compute well, but that an experienced engineer would question."""

from engine import on_use

__getattr__ = on_use(__name__)

COUNT = "warnings"


def is_warning(name: str) -> bool:
    """Whether a summary is the number of warnings, or a flag of one kind of them."""
    return name.partition(".")[0] == COUNT
