"""User files and their errors."""

import errno
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import NamedTuple

from engine import UserError, did_you_mean

# Maximum size of a scene or study [bytes]; long ones have some ten thousand.
LARGEST_TEXT = 16_000_000
# Length of a file name in a message.
_SHOWN = 60
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


class InputError(UserError, ValueError):
    """Invalid input; `problems` holds (line or None, key path, message)."""

    def __init__(self, source: str, problems: list[tuple[int | None, str, str]]) -> None:
        self.source, self.problems = source, tuple(problems)
        super().__init__("\n".join(self._lines()))

    @classmethod
    def of(cls, source: str, message: str, line: int | None = None, key: str = "") -> "InputError":
        """A single problem."""
        return cls(source, [(line, key, message)])

    def _lines(self) -> Iterator[str]:
        for line, key, message in self.problems:
            place = f"{self.source}, line {line}" if line else self.source
            yield f"{place}: {key}: {message}" if key else f"{place}: {message}"


def need_known(names: Iterable[str], known: Iterable[str], source: str, words: str, key: str = "") -> None:
    """Raise an `InputError` if a name is unknown; `words` say why, such as "is not in this result"."""
    known = list(known)
    for name in names:
        if name not in known:
            raise InputError.of(source, f"{name!r} {words}; {did_you_mean(name, known)}", key=key)


class Stamp(NamedTuple):
    """Attributes that change when a file is saved: modification time [ns] and size [bytes]."""

    changed: int
    size: int

    @classmethod
    def of(cls, path: Path) -> "Stamp | None":
        """The stamp of a file; None if there is none."""
        try:
            found = path.stat()
        except (OSError, ValueError):
            return None
        return cls(found.st_mtime_ns, found.st_size)


_read: ContextVar[dict[Path, Stamp | None] | None] = ContextVar("_read", default=None)


@contextmanager
def files_read() -> Iterator[dict[Path, Stamp | None]]:
    """Note the texts that `read_text` reads, with their stamps before reading."""
    noted: dict[Path, Stamp | None] = {}
    token = _read.set(noted)
    try:
        yield noted
    finally:
        _read.reset(token)


def check_file(path: Path, largest: int | None = None) -> None:
    """Check that a path is not a device, a pipe, or too large.

    Parameters
    ----------
    path : Path
    largest : int, optional
        Maximum size [bytes].

    Raises
    ------
    InputError
    """
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        if getattr(error, "errno", None) == errno.ENAMETOOLONG:
            raise InputError.of(f"{str(path)[:_SHOWN]}...", "is too long for a file name") from None
        return
    if not (stat.S_ISREG(found.st_mode) or stat.S_ISDIR(found.st_mode)):
        raise InputError.of(str(path), "is a device or a pipe; name a file")
    if largest is not None and found.st_size > largest:
        message = f"has {found.st_size / 1e6:.0f} MB, more than the allowed {largest / 1e6:.0f} MB"
        raise InputError.of(str(path), message)


def is_hdf5(path: Path) -> bool:
    """Whether a file exists and is HDF5."""
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE
    except (OSError, ValueError):
        return False


def read_text(path: Path, largest: int = LARGEST_TEXT) -> str:
    """Text of a file.

    Parameters
    ----------
    path : Path
    largest : int
        Maximum size [bytes].

    Raises
    ------
    InputError
        The file can't be read, is a device or a pipe, or is too large.
    """
    if (noted := _read.get()) is not None:
        noted[path] = Stamp.of(path)
    check_file(path, largest)
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError.of(str(path), "there is no such file") from None
    except IsADirectoryError:
        raise InputError.of(str(path), "is a folder, not a file") from None
    except OSError as error:
        raise InputError.of(str(path), f"can't be read: {error.strerror}") from None
    except ValueError:
        message = "is not UTF-8 text: save it as UTF-8"
        if is_hdf5(path):
            message = "is a result file (HDF5), not a text; use `sweeps show`"
        raise InputError.of(str(path), message) from None
