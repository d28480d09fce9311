"""Files that are there whole or not at all: written beside, then renamed. And folders for what nobody keeps."""

import errno
import os
import secrets
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sweeps.text.interruption import half_written


@contextmanager
def whole_file(path: Path | str) -> Iterator[Path]:
    """A draft to write, which takes the place of a file once all of it is there; an earlier file stays until then.

    What is there and no regular file, such as /dev/stdout, is written as it is. The draft is created under a name that
    nobody can predict, and never through a link, so that another user of the folder can't redirect what is written.

    Parameters
    ----------
    path : Path or str

    Yields
    ------
    Path
        The draft, an empty file with the same ending.

    Raises
    ------
    OSError
        The system refuses, or the path is a link that belongs to another user than the file's folder.
    """
    path = Path(path)
    refuse_foreign_link(path)
    if path.exists() and not path.is_file():
        yield path
        return
    # The file that a link names is replaced, not the link.
    path = path.resolve()
    draft = path.with_name(f".{secrets.token_hex(8)}{path.suffix}")
    half_written.add(str(draft))
    try:
        os.close(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), 0o666))
        try:
            yield draft
            draft.replace(path)
        finally:
            draft.unlink(missing_ok=True)
    finally:
        half_written.discard(str(draft))


@contextmanager
def scratch_folder(within: Path | str | None = None) -> Iterator[Path]:
    """A folder that only this user reaches, removed at the end, and by a signal too.

    Parameters
    ----------
    within : Path or str, optional
        The folder in which it is made (default: the system's one for such folders).
    """
    with tempfile.TemporaryDirectory(prefix=".sweeps-", dir=within, ignore_cleanup_errors=True) as folder:
        half_written.add(folder)
        try:
            yield Path(folder)
        finally:
            half_written.discard(folder)


def refuse_foreign_link(path: Path) -> None:
    """Refuse a link that neither this user nor the owner of its folder made, as Linux does in shared folders.

    Parameters
    ----------
    path : Path
        Something to be written.

    Raises
    ------
    PermissionError
        It is such a link.
    """
    if path.is_symlink() and path.lstat().st_uid not in (os.geteuid(), path.parent.stat().st_uid):
        raise PermissionError(errno.EACCES, "a link of another user, which is not followed", str(path))
