"""A mechanism drawn to scale with the symbols of the theory of mechanisms: hinges, guides, sliders, slotted links.

`primitives` gives lines, polygons, circles and names in metres and in painting order: what comes later hides what
it covers. `draw` paints them on axes of matplotlib, `picture` to a file.
"""

from sweeps.pictures.drawing.figures import figures, primitives
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.names import names_of_points
from sweeps.pictures.drawing.painting import FILLS, bounds, draw, mechanism_figure, paint, picture, prepare_axes
from sweeps.pictures.drawing.symbols import LAYERS, Primitive

__all__ = [
    "FILLS",
    "LAYERS",
    "DrawnMotion",
    "Primitive",
    "bounds",
    "draw",
    "figures",
    "mechanism_figure",
    "names_of_points",
    "paint",
    "picture",
    "prepare_axes",
    "primitives",
]
