"""Natural frequencies and modes of trains: closed forms, 50 digits, dense matrices with gear constraints, extremes."""

import math

import mpmath
import numpy as np
import pytest
import scipy.linalg
from each_case import refusals
from element_samples import element, results, solved
from hypothesis import given, settings
from hypothesis import strategies as st
from train_samples import BRANCHED, chain, free, frequencies_of, matrices

from engine import Scene, Verdict
from engine.elements.torsional_trains import torsional_train

some = settings(max_examples=15)


def exact_chain(inertias, stiffnesses):
    """Natural frequencies above zero and modes with 60 digits, by mpmath's symmetric eigenvalues."""
    with mpmath.workdps(60):
        n = len(inertias)
        roots = [mpmath.sqrt(mpmath.mpf(float(x))) for x in inertias]
        matrix = mpmath.matrix(n)
        for i, k in enumerate(stiffnesses):
            k = mpmath.mpf(float(k))
            for a, b, sign in ((i, i, 1), (i + 1, i + 1, 1), (i, i + 1, -1), (i + 1, i, -1)):
                matrix[a, b] += sign * k / (roots[a] * roots[b])
        squares, vectors = mpmath.eigsy(matrix)
        modes = [[vectors[i, j] / roots[i] for i in range(n)] for j in range(1, n)]
        tops = [max(mode, key=abs) for mode in modes]
        return (
            np.array([float(mpmath.sqrt(s)) for s in squares[1:]]),
            np.array([[float(q / top) for q in mode] for mode, top in zip(modes, tops, strict=True)]),
        )


sizes = st.floats(-3, 3).map(lambda x: 10**x)
rates = st.floats(-6, 6).map(lambda x: 10**x)


@some
@given(st.lists(sizes, min_size=2, max_size=6), st.lists(rates, min_size=5, max_size=5))
def test_frequencies_and_modes__hold_to_50_digits_whatever_the_ratios(inertias, stiffnesses):
    n = len(inertias)
    stiffnesses = stiffnesses[: n - 1]
    exact, modes = exact_chain(inertias, stiffnesses)
    found = solved(chain(inertias, stiffnesses))
    for k in range(1, n):
        value, error = found[f"frequency_{k}"]
        assert abs(value - exact[k - 1]) <= error
        assert error <= 2e-14 * value
        for i in range(n):
            value, error = found[f"mode_{k}.m{i}"]
            # NaN where two frequencies are too near to tell their modes apart, or two amplitudes are both the greatest.
            off = min(abs(value - modes[k - 1][i]), abs(value + modes[k - 1][i]))
            assert np.isnan(value) or off <= error + 1e-15


def star(branches, stiffness=1e4):
    """Equal branches on one hub: all but two of the frequencies are the same."""
    masses = {"hub": {"inertia": 5.0}} | {f"b{i}": {"inertia": 1.0} for i in range(branches)}
    shafts = {f"s{i}": {"between": ["hub", f"b{i}"], "stiffness": stiffness} for i in range(branches)}
    return {"type": "torsional_train", "masses": masses, "shafts": shafts, "modes": 10}


def test_equal_frequencies__are_all_found_and_their_modes_left_open():
    found = solved(star(4))
    values = [found[f"frequency_{k}"][0] for k in range(1, 5)]
    assert values == pytest.approx([100.0, 100.0, 100.0, 100.0 * math.sqrt(1 + 4 / 5)], rel=1e-14)
    assert all(np.isnan(found[f"mode_{k}.b0"][0]) for k in (1, 2, 3))
    assert [found[f"mode_4.b{i}"][0] for i in range(4)] == pytest.approx([1.0] * 4, rel=1e-12)


@pytest.mark.parametrize("grounded", [False, True])
def test_branched_train_with_gears__is_that_of_the_constraints(grounded):
    train = BRANCHED
    if grounded:
        bar = {"between": ["table", "frame"], "stiffness": 5e4}
        train = train | {"shafts": train["shafts"] | {"bar": bar}}
    inertia, stiffness, _, basis = matrices(train)
    squares, vectors = scipy.linalg.eigh(stiffness, inertia)
    rigid = 0 if grounded else 1
    found = solved(free(train))
    assert found["rigid_body_modes"][0] == rigid
    for k, square in enumerate(squares[rigid:], 1):
        # A dense solver's rounding goes with the greatest square.
        assert found[f"frequency_{k}"][0] == pytest.approx(math.sqrt(square), rel=1e-11)
        angles = basis @ vectors[:, k - 1 + rigid]
        angles = angles / angles[np.abs(angles).argmax()]
        assert [found[f"mode_{k}.{m}"][0] for m in train["masses"]] == pytest.approx(angles, abs=1e-9)


def test_gear_ratio__may_stand_with_a_shaft_that_has_teeth_among_its_parts():
    parts = {
        "input": {"type": "coupling", "stiffness": 2e4},
        "mesh": {"type": "gear_mesh", "mesh_stiffness": 14e9, "width": 0.03, "base_radius": 0.05},
        "output": {"type": "coupling", "stiffness": 5e5, "ratio": 0.25},
    }
    masses = {"motor": {"inertia": 0.2}, "load": {"inertia": 9.0}}
    shaft = {"between": ["motor", "load"], "parts": parts, "ratio": 0.25}
    values, _ = frequencies_of({"type": "torsional_train", "masses": masses, "shafts": {"drive": shaft}})
    k = 1 / (1 / 2e4 + 1 / (14e9 * 0.03 * 0.05**2) + 1 / (5e5 * 0.25**2))
    load = 9.0 * 0.25**2
    assert values == pytest.approx([math.sqrt(k * (0.2 + load) / (0.2 * load))], rel=1e-13)


def test_results__are_named_without_a_search_for_frequencies(monkeypatch):
    train = Scene.model_validate({"elements": {"train": free(BRANCHED)}}).elements["train"]
    found = set(train.evaluate(train.own_numbers()).values)
    monkeypatch.setattr(torsional_train, "natural_vibration", None)
    assert {result.name for result in train.results} == found


def test_thin_walled_shaft__has_a_figure_for_what_its_wall_loses():
    wall = {"type": "shaft", "diameter": 0.1, "bore": 0.1 - 1e-9, "length": 1.0, "shear_modulus": 8e10}
    train = chain([1.0, 2.0], [1.0])
    train["shafts"]["s0"] = {"between": ["m0", "m1"], "parts": {"tube": wall}}
    value, error = (x[0] for x in frequencies_of(train))
    with mpmath.workdps(50):
        d, b = mpmath.mpf(0.1), mpmath.mpf(0.1 - 1e-9)
        exact = mpmath.sqrt(8e10 * mpmath.pi / 32 * (d**4 - b**4) * 1.5)
    assert abs(value - float(exact)) <= error
    # Half a rounding of both diameters moves the wall by 2e-8 of it.
    assert 1e-9 * value < error < 1e-6 * value


def test_shaft_without_a_wall__is_a_status_never_a_number():
    wall = {"type": "shaft", "diameter": 0.1, "bore": 0.05, "length": 1.0, "shear_modulus": 8e10}
    for place in (0, 1):
        train = chain([1.0, 2.0, 0.5], [1e4, 1e4])
        train["shafts"][f"s{place}"] = {"between": [f"m{place}", f"m{place + 1}"], "parts": {"tube": wall}}
        path = f"shafts.s{place}.parts.tube.bore"
        values, _, status = results(train, "frequency_1", "frequency_2", **{path: [0.05, 0.1, 0.11]})
        assert list(status) == [Verdict.OK, Verdict.OUTSIDE_LIMITS, Verdict.OUTSIDE_LIMITS]
        assert np.isnan([v[1:] for v in values.values()]).all()


SERIES = {"type": "series", "parts": {"c": {"type": "coupling", "stiffness": 1.0, "damping": 1.0}}}
DAMPED_PARTS = {
    "masses": {"m0": {"inertia": 1.0}, "m1": {"inertia": 1.0}},
    "shafts": {"s0": {"between": ["m0", "m1"], "parts": {"p": SERIES}}},
}


test_train_that_cannot_be__says_what_to_mend = refusals(
    lambda change: element(chain([1.0, 1.0, 1.0], [1.0, 1.0]) | change),
    ({"shafts": {}}, "no shafts or gears join them"),
    ({"shafts": {"a": {"between": ["m0", "m9"], "stiffness": 1.0}}}, "there is no mass 'm9'"),
    ({"gears": {"g": {"between": ["m0", "m2"], "ratio": 2.0}}}, "closes a loop"),
    ({"gears": {"s0": {"between": ["m0", "m2"], "ratio": 2.0}}}, "distinct names"),
    ({"gears": {"g": {"between": ["m0", "frame"], "ratio": 2.0}}}, "of a gear both"),
    ({"gears": {"g": {"between": ["m0", "m1"], "ratio": 0.0}}}, "its speed over that of the first"),
    ({"shafts": {"a": {"between": ["m0", "m1"]}}}, "give stiffness or parts"),
    ({"shafts": {"a": {"between": ["m0", "m1"], "stiffness": -2.0}}}, "greater than 0"),
    ({"masses": {"m0": {"inertia": 0.0}}}, "greater than 0"),
    ({"masses": {"m0": {"inertia": 1.0}}, "shafts": {}}, "don't vibrate"),
    ({"excitations": {"e": {"on": "m0", "order": 1, "amplitude": 1.0}}}, "speed is missing"),
    ({"speed": 1.0}, "speed changes nothing without an excitation"),
    ({"load": "m1"}, "load changes nothing"),
    ({"masses": {f"m{i}": {"inertia": 1.0, "damping": 0.1} for i in range(3)}}, "masses.m0.damping changes nothing"),
    (DAMPED_PARTS, "shafts.s0.parts.p.parts.c.damping changes nothing"),
    ({"speed": 1.0, "excitations": {"e": {"on": "x", "order": 1, "amplitude": 1.0}}}, "there is no mass 'x'"),
    ({"cylinders_at": ["m0"]}, "give engine"),
    ({"cylinders_at": ["x"]}, "cylinders_at: there is no mass 'x'"),
    ({"load": "x"}, "there is no mass 'x'"),
)
