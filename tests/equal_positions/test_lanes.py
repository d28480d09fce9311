"""Flywheel sizes of variants side by side: those of rows, for any number of variants, and NaN where there is any."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import slider_crank
from numba import njit

import engine.equal_positions.shared_shapes
from engine import Scene
from engine.compiling.jit import KERNEL_OPTIONS
from engine.equal_positions.flywheel import flywheel_sizes, missed_extreme
from engine.equal_positions.lanes import (
    HALF,
    LANES,
    VECTOR,
    WHOLE,
    begin_cycle,
    missed_by_lane,
    room_for_lanes,
    sizes_of_lane,
    two_positions,
    whole_vectors,
)
from engine.equal_positions.rows_machine import RowsMachine as Machine

EPS = 2.3e-16
OMEGA, DELTA, FIRST_KIND = 12.0, 0.05, 0.3


@njit(**{**KERNEL_OPTIONS, "cache": False})
def sizes_side_by_side(work, inertia, work_half):
    """The same cycle in every lane, in each with another multiple of the work."""
    kept = room_for_lanes(0)
    n = work.shape[0]
    for lane in range(LANES):
        scale = 1.0 + lane
        begin_cycle(kept, lane, OMEGA, DELTA, scale * work[n - 2], inertia[n - 2], scale * work[n - 1], inertia[n - 1])
    for k in range(0, n, 2):
        for lane in range(LANES):
            scale = 1.0 + lane
            two_positions(
                kept,
                lane,
                scale * work[k],
                inertia[k],
                scale * work[k + 1],
                inertia[k + 1],
                scale * work_half[k // 2],
            )
    found = np.empty((LANES, 9))
    for lane in range(LANES):
        whole, half = (
            sizes_of_lane(kept, WHOLE, lane, OMEGA, DELTA, FIRST_KIND),
            sizes_of_lane(kept, HALF, lane, OMEGA, DELTA, FIRST_KIND),
        )
        for i in range(4):
            found[lane, i], found[lane, 4 + i] = whole[i], half[i]
        found[lane, 8] = missed_by_lane(kept, lane)
    return found


def by_definition(work, inertia):
    """Sizes from NumPy's extremes of W − ½ω² I, as the module engine.equal_positions.flywheel defines them."""
    slopes = {
        name: 0.5 * (OMEGA * (1 + sign * DELTA / 2)) ** 2 for name, sign in (("slow", -1), ("mean", 0), ("fast", 1))
    }
    slopes["mean"] = 0.5 * OMEGA**2
    loops = {name: work - slope * inertia for name, slope in slopes.items()}
    scale = DELTA * OMEGA**2
    excess = np.ptp(work)
    top, bottom = loops["fast"].max(), loops["slow"].min()
    return [excess, excess / scale, np.ptp(loops["mean"]) / scale - FIRST_KIND, (top - bottom) / scale]


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(4, 60))
def test_lanes__have_the_sizes_of_their_definition(seed, half):
    random = np.random.default_rng(seed)
    work, inertia, work_half = random.normal(size=2 * half), random.uniform(0.1, 2, 2 * half), random.normal(size=half)
    found = sizes_side_by_side(work, inertia, work_half)
    for lane in (0, 7, 8, LANES - 1):
        scale = 1.0 + lane
        # Two roundings of W − ½ω² I, of which neither term exceeds this, and two for the division and the difference.
        largest = scale * 5 + 0.5 * OMEGA**2 * 2.2
        tolerance = 8 * EPS * largest * max(1.0, 1 / (DELTA * OMEGA**2))
        energy = scale * work - 0.5 * OMEGA**2 * inertia
        bends = np.roll(energy, 1) - 2 * energy + np.roll(energy, -1)
        expected = by_definition(scale * work, inertia) + by_definition(scale * work_half, inertia[::2])
        np.testing.assert_allclose(found[lane, :8], expected, rtol=0, atol=tolerance)
        assert found[lane, 8] == pytest.approx(np.abs(bends).max() / 8, abs=8 * EPS * largest)
        assert found[lane, 8] == pytest.approx(
            missed_extreme(inertia, scale * work, 0.5 * OMEGA**2), abs=8 * EPS * largest
        )
        rows = flywheel_sizes(inertia, scale * work, OMEGA, DELTA, FIRST_KIND)
        np.testing.assert_allclose(found[lane, :4], rows, rtol=0, atol=tolerance)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", [0, 5, 11])
def test_not_finite_anywhere__has_no_size(value, where):
    work, inertia = np.sin(np.arange(12.0)), np.ones(12)
    for row in (work, inertia):
        spoilt = [r.copy() for r in (work, inertia)]
        spoilt[0 if row is work else 1][where] = value
        found = sizes_side_by_side(*spoilt, work[::2])
        assert np.isnan(found[:, [0, 1, 2, 3, 8]]).all()


@pytest.mark.parametrize("count", [1, VECTOR - 1, VECTOR, VECTOR + 1, LANES])
def test_lanes__come_in_whole_vectors(count):
    lanes = whole_vectors(count)
    assert lanes % VECTOR == 0
    assert count <= lanes < count + VECTOR
    assert lanes <= LANES


def test_rows_of_lanes__begin_with_a_line_of_the_cache():
    room = room_for_lanes(3)
    assert all(row.ctypes.data % 64 == 0 for row in room)


SCENE = Scene.model_validate(
    slider_crank(
        speed=12.0,
        guides={"way": {"angle": 0.1}},
        gravity=9.81,
        bodies={
            "crank": {"link": "crank", "mass": 2.0, "x": 0.02, "inertia": 0.01},
            "rod": {"link": "rod", "mass": 1.0, "x": 0.08, "y": 0.01, "inertia": 0.004},
            "ram": {"link": "ram", "mass": 3.0},
        },
        forces={"push": {"on": "B", "type": "constant", "angle": 0.3, "force": -400.0}},
        flywheel={"speed_fluctuation": 0.02},
    )
)
ASKED = ["excess_work", "flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer", "required_drive_moment"]


@pytest.mark.parametrize(
    ("paths", "dtype"),
    [
        (["bodies.ram.mass"], "float32"),
        (["forces.push.force"], "float64"),
        (["input.speed", "bodies.crank.mass", "bodies.rod.mass"], "float64"),
    ],
)
@pytest.mark.parametrize("variants", [6, LANES - 1, LANES + 9])
def test_every_number_of_variants__gives_what_each_gives_whole(variants, paths, dtype, monkeypatch):
    numbers = engine.scene_numbers(SCENE)
    random = np.random.default_rng(variants)
    varied = {p: numbers[p].value * random.uniform(0.5, 1.5, variants) for p in paths}
    together, alone = (Machine(SCENE, ASKED, [], varied, 48, np.dtype(dtype).type) for _ in range(2))
    summed = together.evaluate(varied)
    monkeypatch.setattr(engine.equal_positions.shared_shapes, "WORTH_SHARING", 1e9)
    whole = alone.evaluate(varied)
    assert (together.forms_used, alone.forms_used) == ({"factorised"}, {"whole"})
    # 48 positions, six loads: 300 roundings of the largest energy, ½ω²I, against the excess work of the same order.
    rounding = 300 * np.finfo(dtype).eps
    for key in ASKED:
        scale = np.abs(whole.summaries[key]).max() + np.abs(whole.summaries["excess_work"]).max()
        np.testing.assert_allclose(summed.summaries[key], whole.summaries[key], rtol=0, atol=rounding * scale)
        # Figures of the whole differ by the rounding of the values; jumps add up by magnitude in the sum.
        assert (summed.errors[key] >= whole.errors[key] * (1 - 1e-6) - rounding * scale).all()
