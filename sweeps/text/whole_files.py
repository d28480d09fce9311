"""Files that are there whole or not at all: written beside, then renamed."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sweeps.text.interruption import half_written


@contextmanager
def whole_file(path: Path | str) -> Iterator[Path]:
    """A draft to write, which takes the place of a file once all of it is there; an earlier file stays until then.

    What is there and no regular file, such as /dev/stdout, is written as it is.

    Parameters
    ----------
    path : Path or str

    Yields
    ------
    Path
        The draft, with the same ending.
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        yield path
        return
    # The file that a link names is replaced, not the link.
    path = path.resolve()
    draft = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    half_written.add(str(draft))
    try:
        yield draft
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
        half_written.discard(str(draft))
