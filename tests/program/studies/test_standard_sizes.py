"""Sizes of parts on the market: preferred numbers, and studies whose variables take nothing but sizes."""

from itertools import pairwise

import numpy as np
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st
from study_samples import study_of, varying

from engine import STANDARD_SIZES, in_text
from sweeps import Study, SweepResult, run_study
from sweeps.study.sampling import Sampled

PREFERRED = [5, 10, 20, 40]
# Diameters of ISO 3's R20 in mm, copied from a drawing office's table.
R20 = "10 11.2 12.5 14 16 18 20 22.4 25 28 31.5 35.5 40 45 50 56 63 71 80 90 100"


def sizes_of(study: Study, name: str) -> list[float]:
    return np.unique(study.values(0, study.design.size)[0][name]).tolist()


# The series


@each("series", PREFERRED)
def test_preferred_numbers__divide_a_decade_into_equal_ratios_within_rounding(series):
    found = np.array(STANDARD_SIZES[f"R{series}"].between(1e-3, 9.999e-3)) / 1e-3
    # ISO 3: the rounding of R5 to R40 is between −1.01 % and +1.26 %.
    off = found / 10 ** (np.arange(series) / series) - 1
    assert found.size == series
    assert off.min() > -0.0102
    assert off.max() < 0.0127


def test_preferred_numbers__are_those_of_the_table_and_as_written():
    wanted = [in_text(f"{number} mm", "length") for number in R20.split()]
    assert STANDARD_SIZES["R20"].between(0.01, 0.1) == wanted


@given(st.sampled_from(PREFERRED), st.floats(1e-5, 1e3), st.floats(1, 50))
def test_series__holds_all_sizes_of_a_range_and_none_outside(series, low, factor):
    sizes, high = STANDARD_SIZES[f"R{series}"], low * factor
    below, above = sizes.around(low, high)
    found = [below, *sizes.between(low, high), above]
    assert below < low <= high < above
    # Two roundings of 1.3 % in opposite directions.
    assert all(1 < above / below < 10 ** (1 / series) * 1.026 for below, above in pairwise(found))


def test_motors__are_those_of_a_catalogue():
    series = STANDARD_SIZES["IEC"]
    assert series.between(3e3, 11e3) == [3000, 4000, 5500, 7500, 11000]
    assert series.between(10.0, 1e7)[:: len(series.numbers) - 1] == [60, 1e6]
    # Nothing below the first, nothing above the last.
    assert series.around(60.0, 70.0) == [90]
    assert series.around(2e6, 3e6) == [1e6]


# What varies


@each(
    "axis, expected",
    [
        ('{choose = "R20", low = "40 mm", high = "80 mm"}', [0.04, 0.045, 0.05, 0.056, 0.063, 0.071, 0.08]),
        ('{choose = "R5", low = "1.5 in", high = "4 in"}', [0.04, 0.063, 0.1]),
        ('{choose = ["50 mm", "40 mm", "50 mm"]}', [0.04, 0.05]),
        ('{choose = ["1 1/2 in", "1 3/4 in"]}', [0.0381, 0.04445]),
    ],
)
@each("sampling", ["", "[sampling]\ncount = 64\n"])
def test_chosen_sizes__are_a_grid_or_sampled(axis, expected, sampling, study_folder):
    study = varying(study_folder, f'"input.length" = {axis}\n{sampling}')
    assert study.design.size == (64 if sampling else len(expected))
    assert sizes_of(study, "input.length") == expected


@given(st.sampled_from(["random", "sobol", "latin"]), st.integers(1, 9), st.integers(0, 99))
@settings(max_examples=30)
def test_samples__stay_on_sizes_and_take_each_as_often(method, count, seed):
    sizes = STANDARD_SIZES["R40"].between(0.05, 1)[:count]
    axis = Sampled(("a", "b"), (1, sizes[0]), (2, sizes[-1]), 1024, method, seed, (), {"b": sizes})
    found, times = np.unique(axis.values(np.arange(1024))["b"], return_counts=True)
    assert found.tolist() == sizes
    # Strata give each its share within one at either end; independent draws within 6 σ.
    assert abs(times - 1024 / count).max() <= (6 * (1024 / count) ** 0.5 if method == "random" else 2)


# What follows


def test_derivative_and_tolerance__are_those_at_each_size(study_folder):
    vary = '[vary]\n"input.length" = {choose = "R20", low = "40 mm", high = "60 mm"}\n'
    asked = '[outputs]\nsummaries = ["ram.stroke"]\nderivatives = ["ram.stroke by input.length"]\n'
    study = study_of(study_folder, f'scene = "press.toml"\n{vary}{asked}[tolerances]\n"input.length" = "0.1 mm"\n')
    columns = SweepResult(run_study(study, study_folder / "r.h5")).columns
    # In a line with the crank's pivot: the stroke is twice the crank.
    np.testing.assert_allclose(columns["ram.stroke"], [0.08, 0.09, 0.1, 0.112], rtol=1e-9)
    np.testing.assert_allclose(columns["ram.stroke.by.input.length"], 2, rtol=1e-6)
    np.testing.assert_allclose(columns["ram.stroke.tolerance_worst_case"], 2e-4, rtol=1e-6)


@each("sampling", ["", "[sampling]\ncount = 16\n"])
@each("high, ends", [("50 mm", ["input.length"]), ("45 mm", [])])
def test_best_at_the_last_size__is_reported_unless_of_two(sampling, high, ends, study_folder):
    vary = f'[vary]\n"input.length" = {{choose = "R20", low = "40 mm", high = "{high}"}}\n{sampling}'
    asked = '[outputs]\nsummaries = ["ram.stroke"]\n[best]\nmaximise = "ram.stroke"\n'
    result = SweepResult(
        run_study(study_of(study_folder, f'scene = "press.toml"\n{vary}{asked}'), study_folder / "r.h5")
    )
    assert list(result.range_ends(result.best())) == ends
    assert list(result.lists) == ["input.length"]
