"""How much of a variant's time the machine's own functions take: what sharing a geometry could save at most."""

import math
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numba import njit, types

from engine import Machine, Scene, scene_numbers
from engine.compiling.tiles import FILLS_TILE, LANES, TILE_SIGNATURE, TileFunction
from engine.machine.measuring import Measuring
from engine.scene.scene import Numbers

ROUNDS, TIMES_AGAIN = 9, 200
SHAPE_TEXT = """Where many variants share a geometry and differ by masses and loads alone, each is evaluated by itself.
What they share, the machine's own functions, is the smaller part of a variant's time: evaluating it once for all of
them could save no more than the share below. The rest is each variant's own: the places where loads set in, the
extremes of works and moments, the flywheels."""


@njit([types.void(types.intp, FILLS_TILE, *TILE_SIGNATURE.args)])
def _again(
    times: int,
    fills: Callable,
    p: np.ndarray,
    t: np.ndarray,
    q: np.ndarray,
    c: np.ndarray,
    s: np.ndarray,
    tile: np.ndarray,
) -> None:
    for _ in range(times):
        fills(p, t, q, c, s, tile)


def own_functions_time(measuring: Measuring, table: np.ndarray, panels: np.ndarray) -> float:
    """Time of a machine's own functions, in µs per variant: as many panels as its blocks take, and the first scan."""
    machine = measuring.machine
    functions, _, states, curves = machine.task.sizes
    steps = float(np.mean([panels[i : i + LANES].max() for i in range(0, panels.size, LANES)]))
    used = ((machine.events, functions, machine.task.scan), (machine.states, states, 1), (machine.curves, curves, 17))
    seconds, block = 0.0, np.ascontiguousarray(table[:, :LANES])
    for function, rows, positions in used:
        if rows:
            q = np.linspace(0.0, 2.0 * math.pi, positions)[:, None] + np.zeros(LANES)
            given = (block, measuring.functions.memory, q, np.cos(q), np.sin(q), np.empty((rows, positions, LANES)))
            begin = time.process_time()
            _again(TIMES_AGAIN, TileFunction(function), *given)
            once = (time.process_time() - begin) / TIMES_AGAIN
            seconds += once * (1.0 if function is machine.events else steps)
    return seconds / LANES * 1e6


def shape_lines(machines: Mapping[str, tuple[Scene, Sequence[str], dict[str, np.ndarray]]]) -> list[str]:
    """Table of machines by name: scene, what is asked, what varies."""
    lines = ["| machine | whole [µs] | its own functions [µs] | share |", "|---|---|---|---|"]
    for name, (scene, summaries, varied) in machines.items():
        machine, count = Machine(scene, summaries, varied=varied), next(iter(varied.values())).size
        machine.evaluate(varied)
        whole, own = [], []
        for _ in range(ROUNDS):
            begin = time.process_time()
            machine.evaluate(varied)
            whole.append((time.process_time() - begin) / count * 1e6)
            table = machine.measuring.numbers(Numbers(scene_numbers(scene), varied), count)
            panels = machine.measuring(table).outcome.panels
            own.append(own_functions_time(machine.measuring, table, panels))
        share = np.median(np.array(own) / np.array(whole))
        lines.append(f"| {name} | {np.median(whole):.2f} | {np.median(own):.2f} | {share:.0%} |")
        print(lines[-1], flush=True)
    return [*lines, ""]
