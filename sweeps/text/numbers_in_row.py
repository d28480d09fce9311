"""Several numbers with units in one option text."""

from collections.abc import Sequence

from engine import UnitError, in_text
from sweeps.text.input_files import InputError


def numbers_in_row(source: str, text: str, dimensions: Sequence[str]) -> tuple[float, ...]:
    """Numbers separated by commas, such as "40 mm, 25 mm, 20 deg", in SI.

    Parameters
    ----------
    source : str
        Source of the text, for messages.
    text : str
    dimensions : sequence of str
        Dimension of each number.

    Raises
    ------
    InputError
        Wrong number of values, or a wrong dimension.
    """
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != len(dimensions):
        message = f"{text!r}: {len(dimensions)} numbers are needed, separated by commas: {', '.join(dimensions)}"
        raise InputError.of(source, message)
    try:
        return tuple(in_text(part, dimension) for part, dimension in zip(parts, dimensions, strict=True))
    except UnitError as error:
        raise InputError.of(source, str(error)) from None
