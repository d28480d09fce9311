"""Mechanisms drawn to scale with standard symbols: hinges, guides, sliders, slotted links.

`primitives` gives lines, polygons, circles and names in metres in painting order: later ones cover earlier ones. `draw`
paints them on Matplotlib axes, `picture` to a file.
"""

from sweeps.pictures.drawing.figures import figures, primitives
from sweeps.pictures.drawing.motion import DrawnMotion, position_text
from sweeps.pictures.drawing.moving_drawing import MovingDrawing, MovingFigure, moving_drawing
from sweeps.pictures.drawing.names import names_of_points
from sweeps.pictures.drawing.painting import FILLS, bounds, draw, paint, picture, prepare_axes
from sweeps.pictures.drawing.symbols import LAYERS, Primitive
