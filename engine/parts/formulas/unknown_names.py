"""Names that aren't known, and those that may have been meant."""

import difflib
from collections.abc import Iterable


def unknown_name_message(name: str, known: Iterable[str]) -> str:
    """Say that a name is unknown, and which known ones may have been meant.

    Parameters
    ----------
    name : str
        The name that isn't known.
    known : iterable of str
        The names that are.

    Returns
    -------
    str
        For instance "unknown name 'input.lenght'; did you mean 'input.length'?".
    """
    known = sorted(known)
    close = difflib.get_close_matches(name, known, n=3)
    if close:
        return f"unknown name '{name}'; did you mean {' or '.join(map(repr, close))}?"
    if not known:
        return f"unknown name '{name}'; no names are known here"
    more = f" and {len(known) - 20} more" if len(known) > 20 else ""
    return f"unknown name '{name}'; known are {', '.join(known[:20])}{more}"
