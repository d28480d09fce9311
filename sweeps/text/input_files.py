"""Files that a user names: their text, and what is wrong with it."""

from collections.abc import Iterator
from pathlib import Path

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


class InputError(ValueError):
    """A text that is refused; `problems` holds (line or None, key path, message)."""

    def __init__(self, source: str, problems: list[tuple[int | None, str, str]]) -> None:
        self.source, self.problems = source, tuple(problems)
        super().__init__("\n".join(self._lines()))

    def _lines(self) -> Iterator[str]:
        for line, key, message in self.problems:
            place = f"{self.source}, line {line}" if line else self.source
            yield f"{place}: {key}: {message}" if key else f"{place}: {message}"


def is_hdf5(path: Path) -> bool:
    """Whether a file is there and begins as an HDF5 file does."""
    try:
        with path.open("rb") as file:
            return file.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE
    except (OSError, ValueError):
        return False


def read_text(path: Path) -> str:
    """Text of a file.

    Raises
    ------
    InputError
        The file can't be read.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(str(path), [(None, "", f"can't be read: {error.strerror}")]) from None
    except ValueError:
        is_result = is_hdf5(path)
        message = (
            "is a result file (HDF5), not a text; look at it with `sweeps show`"
            if is_result
            else "is not UTF-8 text, as scenes, studies and tables are"
        )
        raise InputError(str(path), [(None, "", message)]) from None
