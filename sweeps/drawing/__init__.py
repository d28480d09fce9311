"""A mechanism drawn to scale with the symbols of the theory of mechanisms: hinges, guides, sliders, slotted links.

`primitives` gives lines, polygons, circles and names in metres and in painting order: what comes later hides what
it covers. `draw` paints them on axes of matplotlib, `picture` to a file.
"""

from sweeps.drawing.figures import figures, primitives
from sweeps.drawing.motion import Motion
from sweeps.drawing.names import names_of_points
from sweeps.drawing.painting import FILLS, bounds, draw, paint, picture, prepare
from sweeps.drawing.symbols import LAYERS, Primitive

__all__ = [
    "FILLS",
    "LAYERS",
    "Motion",
    "Primitive",
    "bounds",
    "draw",
    "figures",
    "names_of_points",
    "paint",
    "picture",
    "prepare",
    "primitives",
]
