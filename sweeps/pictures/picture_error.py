"""Error of plots, importable without the plotting libraries."""

from typing import TYPE_CHECKING

from engine import UserError

if TYPE_CHECKING:
    from engine import Scene


class PictureError(UserError, ValueError):
    """A plot can't be drawn."""

    @classmethod
    def of(cls, file: str, message: str) -> "PictureError":
        """An error of a file."""
        return cls(f"{file} {message}")


def need_mechanism(scene: "Scene") -> None:
    """Raise a `PictureError` if a scene has no mechanism."""
    if scene.input is None:
        raise PictureError("the scene has only machine elements: there is no mechanism to draw")
