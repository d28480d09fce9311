"""Version of this program, and of the one that made a file."""

from importlib.metadata import PackageNotFoundError, version


def own_version() -> str:
    """Installed version of this program."""
    try:
        return version("machine-sweeps")
    except PackageNotFoundError:
        return "not installed"


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
