"""Atomic file writing, and temporary folders."""

import errno
import os
import secrets
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from sweeps.text.input_files import InputError
from sweeps.text.interruption import half_written


@contextmanager
def whole_file(path: Path | str) -> Iterator[Path]:
    """A draft that replaces a file when complete; an earlier file stays until then.

    Non-regular files such as /dev/stdout are written directly. The draft has an unpredictable name and follows no
    link, so that other users of the folder can't redirect the output.

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
        System error, or the path is a link owned by neither this user nor the folder's owner.
    """
    path = Path(path)
    refuse_foreign_link(path)
    if path.exists() and not path.is_file():
        yield path
        return
    # Replace the target of a link, not the link.
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
def new_file(path: Path | str, refusal: Callable[[str, str], Exception] = InputError.of) -> Iterator[Path]:
    """A draft, as for `whole_file`, in a folder made for it; system errors become errors for the user.

    Parameters
    ----------
    path : Path or str
    refusal : callable
        Makes the error from the file's name and what is wrong with it.

    Raises
    ------
    InputError, or as `refusal` says
        The file can't be written.
    """
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as draft:
            yield draft
    except OSError as error:
        raise refusal(str(path), f"can't be written: {error.strerror}") from None


def write_whole_text(path: Path, text: str) -> None:
    """Write a text file as a whole; raises an `InputError` if that fails."""
    with new_file(path) as draft:
        draft.write_text(text, encoding="utf8")


@contextmanager
def scratch_folder(within: Path | str | None = None) -> Iterator[Path]:
    """A private folder, removed at the end and on signals.

    Parameters
    ----------
    within : Path or str, optional
        Parent folder (default: the system's temporary folder).
    """
    with tempfile.TemporaryDirectory(prefix=".sweeps-", dir=within, ignore_cleanup_errors=True) as folder:
        half_written.add(folder)
        try:
            yield Path(folder)
        finally:
            half_written.discard(folder)


def refuse_foreign_link(path: Path) -> None:
    """Reject a link owned by neither this user nor its folder's owner, as Linux does in shared folders.

    Parameters
    ----------
    path : Path
        File to write.

    Raises
    ------
    PermissionError
        It is such a link.
    """
    if path.is_symlink() and path.lstat().st_uid not in (os.geteuid(), path.parent.stat().st_uid):
        raise PermissionError(errno.EACCES, "a link owned by another user, which is not followed", str(path))
