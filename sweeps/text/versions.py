"""Which version of this program is running, and which one made a file."""

from importlib.metadata import PackageNotFoundError, version


def own_version() -> str:
    """Version of this program, as installed."""
    try:
        return version("machine-sweeps")
    except PackageNotFoundError:
        return "not installed"


def origin_text(versions: str) -> str:
    """Say where a file comes from that isn't as this version writes it.

    Parameters
    ----------
    versions : str
        The file's attribute `versions`, "" if it has none.
    """
    maker, own = versions.split(",")[0].strip(), f"machine-sweeps {own_version()}"
    if maker.startswith("machine-sweeps ") and maker != own:
        return f"it was made by {maker}, and this is {own}"
    return "it was edited, or made by another program"
