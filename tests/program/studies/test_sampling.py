import math
from fractions import Fraction

import numpy as np
from each_case import each, refusals
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import qmc

from sweeps.study.sampling import Columns, Design, Listed, Sampled, Steps
from sweeps.study.unit_points import latin_points, permuted, random_points, sobol_points

EPS = np.finfo(float).eps
METHODS = ["random", "sobol", "latin"]
PAIR = ("input.length", "bodies.rod.mass")


def every(axis):
    """All values of an axis, by name."""
    return axis.values(np.arange(axis.size))


def pair(count, method, seed=3, **more):
    return Sampled(PAIR, (0.1, 1.0), (0.2, 100.0), count, method, seed, **more)


# --- single axes -------------------------------------------------------------------------------------------

finite = st.floats(-1e150, 1e150)


@given(finite, finite, st.integers(2, 300))
def test_linear__is_linspace_with_exact_ends(start, stop, count):
    found = every(Steps("a.b", start, stop, count))["a.b"]
    assert found[0] == start
    assert found[-1] == stop
    # linspace rounds step, product and sum, this one once or as often; where the step underflows, to 5e-324 each.
    rounded = 3 * EPS * max(abs(start), abs(stop)) + count * 5e-324
    np.testing.assert_allclose(found, np.linspace(start, stop, count), rtol=0, atol=rounded)


@given(st.integers(-(10**6), 10**6), st.integers(-(10**6), 10**6), st.integers(0, 9), st.integers(2, 300))
def test_linear__has_the_numbers_that_a_person_would_write(first, last, places, count):
    start, stop = (Fraction(end, 10**places) for end in (first, last))
    found = every(Steps("a", float(start), float(stop), count))["a"]
    # Correctly rounded, as a number of the text is.
    assert found.tolist() == [float(start + (stop - start) * i / (count - 1)) for i in range(count)]


@given(st.floats(1e-100, 1e100), st.floats(1e-100, 1e100), st.integers(2, 300), st.sampled_from([1, -1]))
def test_logarithmic__is_geomspace_with_exact_ends(start, stop, count, sign):
    found = every(Steps("a", sign * start, sign * stop, count, True))["a"]
    assert found[0] == sign * start
    assert found[-1] == sign * stop
    # exp(x) magnifies the relative error of x (three roundings at most, in each of the two) by |x| <= 461.
    np.testing.assert_allclose(found, np.geomspace(sign * start, sign * stop, count), rtol=3 * 2 * 461 * EPS)


# --- points in the unit cube -------------------------------------------------------------------------------


@each("dimensions, seed", [(1, 0), (3, 7), (9, 2**64 - 1)])
def test_sobol__is_scipys_drawn_whole(dimensions, seed):
    count = 2**17
    expected = qmc.Sobol(dimensions, rng=seed).random(count)
    np.testing.assert_array_equal(sobol_points(seed, count, dimensions, np.arange(count)), expected)


def test_sobol__reaches_its_last_point():
    # The largest allowed index has every bit set; its point is checked against a sequence stepped there.
    count = 2**21
    engine = qmc.Sobol(2, rng=5).fast_forward(count - 1)
    np.testing.assert_array_equal(sobol_points(5, count, 2, np.array([count - 1])), engine.random(1))


@each("count", [1, 2, 3, 5, 16, 97, 1000, 4099])
@each("seed", [0, 1])
def test_latin__has_one_point_per_stratum_in_each_dimension(count, seed):
    points = latin_points(seed, count, 6, np.arange(count))
    assert points.min() >= 0
    assert points.max() < 1
    strata = np.floor(points * count).astype(int)
    np.testing.assert_array_equal(np.sort(strata, axis=0), np.arange(count)[:, None].repeat(6, axis=1))


@settings(max_examples=60)
@given(st.integers(1, 5000), st.lists(st.integers(0, 2**64 - 1), min_size=10, max_size=10))
def test_permuted__is_a_permutation(count, keys):
    found = permuted(np.arange(count), count, np.array(keys, dtype=np.uint64))
    np.testing.assert_array_equal(np.sort(found), np.arange(count))


@each("points", [random_points, latin_points])
def test_moments_and_correlations__are_within_five_sigma(points):
    count, dimensions = 20_000, 9
    drawn = points(11, count, dimensions, np.arange(count))
    # Standard deviation of the mean of uniform numbers; a Latin hypercube does better.
    assert np.all(np.abs(drawn.mean(axis=0) - 0.5) < 5 / math.sqrt(12 * count))
    # Variance 1/12; the standard deviation of its estimate is sqrt((1/80 - 1/144) / count).
    assert np.all(np.abs(drawn.var(axis=0) - 1 / 12) < 5 * math.sqrt((1 / 80 - 1 / 144) / count))
    # Between dimensions, and between each point and the next: independent, so 1 / sqrt(count).
    both = np.hstack([drawn[:-1], drawn[1:]])
    correlations = np.corrcoef(both.T) - np.eye(2 * dimensions)
    assert np.all(np.abs(correlations) < 5 / math.sqrt(count))


def test_random__is_numpys_philox():
    generator = np.random.Generator(np.random.Philox(key=np.array([42, 0], dtype=np.uint64)))
    np.testing.assert_array_equal(random_points(42, 50, 4, np.arange(50)), generator.random((50, 4)))


@each("method", METHODS)
def test_seeds__give_different_samples(method):
    first, second = every(pair(64, method, seed=1)), every(pair(64, method, seed=2))
    assert not np.any(first[PAIR[0]] == second[PAIR[0]])


@each("method", ["random", "sobol"])
def test_larger_count__keeps_the_earlier_samples(method):
    few, many = every(pair(100, method)), every(pair(70_000, method))
    for name in PAIR:
        np.testing.assert_array_equal(few[name], many[name][:100])


# --- sampled axes ------------------------------------------------------------------------------------------


@given(st.floats(1e-6, 1e6), st.integers(0, 20), st.booleans(), st.sampled_from([1, -1]))
def test_sampled__stays_within_its_limits(near, width, is_logarithmic, sign):
    # A range of a few units in the last place is where rounding would lead out.
    low, high = sorted((sign * near, sign * (near + width * math.ulp(near))))
    axis = Sampled(("a",), (low,), (high,), 200, logarithmic=(is_logarithmic,))
    found = every(axis)["a"]
    assert found.min() >= low
    assert found.max() <= high


def test_note__warns_of_sobol_counts_that_are_no_power_of_two():
    assert pair(128, "sobol").note == ""
    assert pair(100, "random").note == ""
    assert "64 or 128" in pair(100, "sobol").note
    assert PAIR[0] in pair(100, "sobol").note


# --- designs -----------------------------------------------------------------------------------------------


axes = {
    "x": st.builds(Steps, st.just("x"), st.just(0.1), st.just(0.7), st.integers(2, 9)),
    "l": st.builds(Steps, st.just("l"), st.just(0.1), st.just(7.0), st.integers(2, 9), st.just(True)),
    "s": st.builds(
        Sampled, st.just(("s", "t")), st.just((1, -3)), st.just((2, -1)), st.integers(1, 70),
        st.sampled_from(METHODS), st.integers(0, 9), st.just((False, True)),
    ),
    "c": st.just(Columns(("c", "d"), ((1, 2), (3, 4)))),
}  # fmt: skip


@st.composite
def designs(draw):
    chosen = draw(st.permutations(list(axes)))[: draw(st.integers(0, 4))]
    return Design(tuple(draw(axes[key]) for key in chosen))


@settings(max_examples=100)
@given(designs(), st.data())
def test_block__is_bit_identical_to_the_whole(design, data):
    start = data.draw(st.integers(0, design.size))
    stop = data.draw(st.integers(start, design.size))
    whole, block = design.values(0, design.size), design.values(start, stop)
    assert tuple(block) == design.names
    for name in design.names:
        assert block[name].dtype == np.float64
        assert block[name].tobytes() == whole[name][start:stop].tobytes()


@settings(max_examples=25)
@given(st.sampled_from(METHODS), st.lists(st.integers(0, 99_999), max_size=20))
def test_scattered_indices__are_bit_identical_to_the_whole(method, indices):
    axis = pair(100_000, method, logarithmic=(True, True))
    indices = np.array(indices, dtype=np.int64)
    whole, some = every(axis), axis.values(indices)
    for name in PAIR:
        assert some[name].tobytes() == whole[name][indices].tobytes()


# --- refusals ----------------------------------------------------------------------------------------------


test_wrong_choice__is_refused_with_path_and_value = refusals(
    lambda make: make(),
    (lambda: Listed("a.b", [1.0, math.nan]), "a.b … value 2 … nan … finite"),
    (lambda: Steps("a.b", 0, 1, 1), "a.b … both ends … 2 or more"),
    (lambda: Steps("a.b", 0, math.inf, 3), "a.b … finite"),
    (lambda: Steps("a.b", -1.7e308, 1.7e308, 3), "a.b … finite"),
    (lambda: Steps("a.b", -1.0, 2.0, 3, True), "a.b … zero"),
    (lambda: Steps("a.b", 0, 2.0, 3, True), "a.b … zero"),
    (lambda: Steps("a.b", 1e-200, 1e200, 3, True), "a.b … ratio"),
    (lambda: Sampled(("a",), (0.0,), (math.nan,), 4), "a … finite"),
    (lambda: Sampled(("a",), (0.0,), (1.0,), 4, logarithmic=(True,)), "a … zero"),
    (lambda: pair(2**30 + 1, "sobol"), "1073741825 … 'random' or 'latin'"),
    (lambda: Design((Listed("a", [1]), Steps("a", 0, 1, 2))), "a: varies twice"),
    (lambda: Design((Steps("a", 0, 1, 2**40), Steps("b", 0, 1, 2**40))), f"{2**80} … at most"),
    (lambda: Design((Listed("a", [1]),)).values(0, 2), "0 to 2 … 0 to 1"),
    (lambda: Design((Listed("a", [1]),)).values(-1, 1), "-1 to 1"),
    (lambda: Design((Listed("a", [1, 2]),)).values(2, 1), "2 to 1"),
)
