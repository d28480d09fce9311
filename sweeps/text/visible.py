"""Safe display of texts from files: control and direction characters are spelled out."""

import re

# Control characters except line breaks and tabs, separators of lines, and marks of writing direction.
_ACTING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff\ufff9-\ufffb]"
)


def visible(text: str) -> str:
    r"""Return a text with control and direction characters spelled out, as in \\x1b or \\u202e.

    Parameters
    ----------
    text : str
        Untrusted text.
    """
    return _ACTING.sub(lambda found: ascii(found[0])[1:-1], text)
