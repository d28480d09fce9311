"""Errors of the store when a file cannot be made, written or read."""

import errno
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from engine import UserError

_FULL = "The disk or the quota is full, or a file-size limit is reached. Make room or give another --out."
_DENIED = "The system does not allow it. Look at the permissions, or give another --out."
_NO_LOCKS = "This file system has no locks: set HDF5_USE_FILE_LOCKING=FALSE and run one sweep per file."
_BUSY = "Another sweep is writing it, or another program has it open. Wait for it, or give another --out."
_ENOTSUPP = 524  # Used by Linux NFS and Lustre, missing in errno

_REMEDIES = {
    errno.EAGAIN: _BUSY,
    **dict.fromkeys((errno.ENOLCK, errno.ENOSYS, _ENOTSUPP), _NO_LOCKS),
    **dict.fromkeys((errno.ENOSPC, errno.EFBIG, errno.EDQUOT), _FULL),
    **dict.fromkeys((errno.EACCES, errno.EPERM, errno.EROFS), _DENIED),
    errno.ENOENT: "The file or its folder does not exist.",
    errno.ENOTDIR: "Its folder is not a folder.",
    errno.EISDIR: "This is a folder. Give a file name.",
}


class StoreError(UserError):
    """A result file cannot be made, continued, written or read; the text says why and what to do."""


class DamagedError(StoreError):
    """A result file is truncated or modified."""


def make_folder_of(path: Path) -> None:
    """Make the folder of a result file.

    Raises
    ------
    StoreError
        It can't be made.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(f"{path.parent}: can't be made: {error.strerror}") from None


@contextmanager
def explained(
    path: Path, action: str, remedy: str = "System error.", otherwise: type[StoreError] = StoreError
) -> Iterator[None]:
    """Turn errors of h5py and the operating system inside the block into a `StoreError`.

    Parameters
    ----------
    path : Path
        The file worked on.
    action : str
        The failing action, as in "cannot `write` out.h5".
    remedy : str
        Advice for unknown error numbers.
    otherwise : type
        Error class for these.

    Raises
    ------
    StoreError
        Naming the path, the remedy and the system's words.
    """
    try:
        yield
    except (OSError, RuntimeError, ValueError, LookupError, ArithmeticError, TypeError, AttributeError) as error:
        number = _number(error)
        if number in _REMEDIES:
            # HDF5's errors lack the system's message; the refusal of a foreign link has a message of its own.
            words = (isinstance(error, PermissionError) and error.strerror) or os.strerror(number)
            raise StoreError(f"cannot {action} {path}: {words}. {_REMEDIES[number]}") from error
        raise otherwise(f"cannot {action} {path}: {remedy} ({error})") from error


def is_busy(error: Exception) -> bool:
    """Whether opening failed because another process holds the lock."""
    return _number(error) == errno.EAGAIN


def _number(error: Exception) -> int:
    number = getattr(error, "errno", None)
    if number:
        return number
    # Some HDF5 failures are a RuntimeError with the number only in the text.
    found = re.search(r"errno = (\d+)", str(error))
    return int(found.group(1)) if found else 0
