"""Error of plots, importable without the plotting libraries."""


class PictureError(ValueError):
    """A plot can't be drawn."""
