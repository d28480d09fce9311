"""Version of this program, of the one that made a file, and the libraries of the program's extras."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import PackageNotFoundError, version


def versions_of(*names: str) -> dict[str, str]:
    """Versions of the libraries that are installed, by their names."""
    found = {}
    for name in names:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def own_version() -> str:
    """Installed version of this program."""
    return versions_of("machine-sweeps").get("machine-sweeps", "not installed")


@contextmanager
def extra(name: str, purpose: str, refusal: Callable[[str], Exception]) -> Iterator[None]:
    """Import libraries of one of the program's extras inside the block.

    Parameters
    ----------
    name : str
        The extra, as in "machine-sweeps[`parquet`]".
    purpose : str
        What needs them, for the message.
    refusal : callable
        The error to raise with that message if a library isn't installed.
    """
    try:
        yield
    except ImportError as error:
        library = (error.name or name).partition(".")[0]
        raise refusal(f"{purpose} needs {library}: pip install 'machine-sweeps[{name}]'") from None


def origin_text(versions: str) -> str:
    """Origin of a file that differs from this version's format.

    Parameters
    ----------
    versions : str
        The file's attribute `versions`, "" if it has none.
    """
    maker, own = versions.split(",")[0].strip(), f"machine-sweeps {own_version()}"
    if maker.startswith("machine-sweeps ") and maker != own:
        return f"it was made by {maker}, and this is {own}"
    return "it was edited, or made by another program"
