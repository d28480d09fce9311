"""A machine evaluated at positions of each variant's own, which lie in panels between the places where loads set in."""

import math
from collections.abc import Iterable

import numpy as np

from engine.compiling.jit import run_kernel
from engine.equal_positions.text.kernels import KernelWriter, Source
from engine.machine.machine import ROUNDING, Machine
from engine.machine.quantities.quantities import Quantity
from engine.panels.landmarks import Landmarks
from engine.panels.panels import CLEAR, cut, most_edges
from engine.scene.parts import CrankInput
from engine.scene.scene import Numbers, Scene

USED = Quantity("positions_used", "positions per cycle that the accuracy took", "1")
ENDS = ("low", "high", "low_at", "high_at")
# Longest panel of the fewest positions [rad, or a fraction of the range of a sliding input], and the share of it up to
# which a panel is of the lower degree.
LONGEST, LONGEST_SLIDE, SHORT = math.pi / 2, 0.25, 0.25


class PanelMachine(Machine):
    """A machine evaluated in panels (see `engine.panels.panels`); it has summaries only.

    Parameters
    ----------
    scene : Scene
    summaries : iterable of str
    varied : iterable of str
    cuts : int
        A quarter of a turn, or of the range of a sliding input, is cut into so many panels where no load sets in.
    """

    form = "panels"

    def __init__(self, scene: Scene, summaries: Iterable[str], varied: Iterable[str] = (), cuts: int = 1) -> None:
        self.longest = (LONGEST if isinstance(scene.input, CrankInput) else LONGEST_SLIDE) / cuts
        super().__init__(scene, summaries, (), varied)

    @property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary one may ask, with how many positions were used."""
        return super().available_summaries | {USED.name: USED}

    @property
    def possible(self) -> bool:
        """Whether panels suit the machine: its crank turns fully, or no load sets in over the range of its input."""
        drive = self.scene.input
        rising = not isinstance(drive, CrankInput) or self.has_cycle or drive.start < drive.stop
        return rising and (self.has_cycle or not self._landmarks.watches)

    @property
    def _range(self) -> tuple[float, float]:
        """Crank angles of the first and the last position [rad], or 0 and 1 of a sliding input."""
        if self.has_cycle:
            return 0.0, self._landmarks.cycle
        drive = self.scene.input
        return (drive.start, drive.stop) if isinstance(drive, CrankInput) else (0.0, 1.0)

    def _make_writer(self) -> KernelWriter:
        self._landmarks = Landmarks(self.model)
        self._ends = tuple(f"{end}__{slider}" for slider in self._landmarks.sliders for end in ENDS)
        return KernelWriter(self.model, self.analyses, [], self._computed, self._ends)

    def _run(
        self, parameters: np.ndarray, numbers: Numbers, fields: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        source, variants = self.source("panels"), parameters.shape[1]
        speed = np.broadcast_to(numbers["input.speed"], variants)
        first, last = self._range
        if self.has_cycle:
            ends, breaks = self._landmarks(numbers, variants, np.sign(speed))
            angles = np.ascontiguousarray(np.sort(np.mod(breaks.angles, last), axis=0).T)
        else:
            ends, angles = {}, np.empty((variants, 0))
        edges = np.empty((variants, most_edges(angles.shape[1], last - first, self.longest)))
        cut(variants, angles, first, last, self.longest, edges)
        strokes = np.array([getattr(ends[s], end) for s in self._landmarks.sliders for end in ENDS])
        values = np.empty((variants, len(self._computed)))
        errors, troubles, checks = np.empty_like(values), np.empty(variants), np.empty(variants)
        run_kernel(
            source.text,
            "kernel",
            variants,
            parameters,
            edges,
            SHORT * self.longest,
            CLEAR if self.has_cycle else 0.0,
            strokes.reshape(len(self._ends), variants),
            ROUNDING * float(np.finfo(np.float64).eps),
            *self._tables(source),
            values,
            errors,
            fields,
            troubles,
            checks,
        )
        return values, errors, troubles, checks

    def _tables(self, source: Source) -> list[object]:
        tables = self.model.moments.tables | self.model.moments.angle_tables
        return [value for name in source.tables for value in tables[name]]

    def _jammed_at(self, places: np.ndarray, parameters: np.ndarray) -> np.ndarray:
        return places
