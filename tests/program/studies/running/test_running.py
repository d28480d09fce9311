"""Running studies into files: what the file holds, failing variants, threads and blocks."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from each_case import each
from press_sweeps import DISTINCT, FIELDS, GOOD, STROKE, numbers_in, run, study_of, text_of

from engine import Verdict
from sweeps import SweepResult
from sweeps.report.check_report import check_text
from sweeps.report.result_report import counts_text
from sweeps.run import runner
from sweeps.run.blocks import BYTES_PER_BLOCK, LARGEST_BLOCK, block_size
from sweeps.store import MappedResult
from sweeps.study.study_reader import read_study

# What the file holds

# Name: (type, dimensions, units, meaning), as other tools see them.
SCHEMA = {
    "variant": ("<i4", ("variant",), "1", "number of the design variant"),
    "phi": ("<f8", ("phi",), "rad", "crank angle"),
    "input.length": ("<f8", ("variant",), "m", "input.length"),
    "bodies.ram.mass": ("<f8", ("variant",), "kg", "bodies.ram.mass"),
    "status": ("|u1", ("variant",), "1", "verdict"),
    "status_group": ("<i2", ("variant",), "1", "number of the failing group, element or regime, -1 if none"),
    "status_at": ("<f8", ("variant",), "rad", "input position at which the variant fails"),
    "ram.stroke": ("<f8", ("variant",), "m", "stroke of slider ram"),
    "ram.stroke_error": ("<f8", ("variant",), "m", "error estimate of: stroke of slider ram"),
    "rocker.swing": ("<f8", ("variant",), "rad", "swing of link rocker"),
    "rocker.swing_error": ("<f8", ("variant",), "rad", "error estimate of: swing of link rocker"),
    "excess_work": ("<f8", ("variant",), "J", "excess work"),
    "excess_work_error": ("<f8", ("variant",), "J", "error estimate of: excess work"),
    "ram.slide": ("<f8", ("variant", "phi"), "m", "displacement of slider ram"),
    "reduced_moment": ("<f8", ("variant", "phi"), "N m", "reduced moment of all loads except the drive"),
}
PARAMETERS = "input.length bodies.ram.mass"
MEANINGS = """ok cannot_assemble singular outside_limits dropped not_finite stalls runs_away no_end jams any_speed locks
no_inertia unstable resonance does_not_fit self_locks stands slides undercut lifts_off slips mode_not_reached other_mode
grows turns_back too_coarse does_not_close interferes contact_breaks shaft_rigid
fraction_of_a_tooth modules_differ axes_apart uneven_planets planets_touch bore_too_large"""
CODES = dict(enumerate(MEANINGS.split())) | {255: "not_computed"}


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Path:
    return run(tmp_path_factory.mktemp("golden"), GOOD)


def test_file__has_exactly_these_datasets(result):
    with h5py.File(result, "r") as file:
        assert set(file) == {*SCHEMA, "progress"}
        for name, (dtype, dims, units, long_name) in SCHEMA.items():
            dataset = file[name]
            assert dataset.dtype.str == dtype, name
            assert dataset.shape == tuple({"variant": 4, "phi": 48}[d] for d in dims), name
            assert dataset.attrs["units"] == units, name
            assert dataset.attrs["long_name"] == long_name, name
            if name in ("variant", "phi"):
                assert dataset.is_scale
            else:
                assert tuple(dataset.dims[i][0].name for i in range(len(dims))) == tuple(f"/{d}" for d in dims), name
            coordinate = name in ("variant", "phi", "input.length", "bodies.ram.mass")
            assert dataset.attrs.get("coordinates") == (None if coordinate else PARAMETERS), name


def test_file__says_what_its_codes_mean(result):
    with h5py.File(result, "r") as file:
        values, meanings = file["status"].attrs["flag_values"], file["status"].attrs["flag_meanings"].split()
        assert dict(zip(values.tolist(), meanings, strict=True)) == CODES
        assert values.dtype == file["status"].dtype


def test_file__tells_where_it_comes_from(result):
    with h5py.File(result, "r") as file:
        attributes = {k: v.decode() if isinstance(v, bytes) else v for k, v in file.attrs.items()}
    assert attributes["Conventions"] == "CF-1.11"
    assert attributes["title"] == "Which crank?"
    assert attributes["question"] == "How short?"
    assert attributes["study"] == GOOD
    record = json.loads(attributes["study_json"])
    assert " ".join(record["parameters"]) == PARAMETERS
    assert record["best"] == {"minimise": "excess_work", "maximise": None, "where": ["ram.stroke > '80 mm'"]}
    assert record["groups"] == ["bars", "press"]
    axes = [(axis["names"], axis["size"]) for axis in record["vary"]]
    assert axes == [(["input.length"], 2), (["bodies.ram.mass"], 2)]
    assert len(attributes["study_hash"]) == 64
    for word in ("machine-sweeps", "numba", "llvmlite", "numpy", "h5py", "python"):
        assert f"{word} " in attributes["versions"]
    assert "threads" in attributes["machine"]
    assert attributes["finished"].startswith("20")
    assert set(attributes) == {
        *("Conventions", "title", "question", "study", "study_json", "scene", "study_hash", "versions", "machine"),
        *("finished", "outcome", "scene_text"),
    }
    assert SweepResult(result).scene == study_of(result.parent, GOOD).scene


def test_file__opens_as_a_dataset_without_help(result):
    with xarray.open_dataset(result, engine="h5netcdf") as data:
        assert dict(data.sizes) == {"variant": 4, "phi": 48}
        assert set(data.coords) == {"variant", "phi", "input.length", "bodies.ram.mass"}
        assert set(data.data_vars) == set(SCHEMA) - set(data.coords)
        assert data["ram.slide"].dims == ("variant", "phi")
        np.testing.assert_allclose(data["phi"], np.arange(48) * 2 * np.pi / 48, rtol=4e-16)
        assert data["input.length"].values.tolist() == [0.04, 0.04, 0.05, 0.05]
        assert data["bodies.ram.mass"].values.tolist() == [50.0, 100.0, 50.0, 100.0]
        # In line, the stroke is twice the crank; error estimates are true bounds here.
        assert (abs(data["ram.stroke"] - 2 * data["input.length"]) <= data["ram.stroke_error"]).all()
        slide = 0.04 * np.cos(data["phi"]) + np.sqrt(0.04 - (0.04 * np.sin(data["phi"])) ** 2)
        # A dozen operations on numbers below 0.25.
        np.testing.assert_allclose(data["ram.slide"][0], slide, rtol=0, atol=1e-15)
        assert (data["status"] == 0).all()
        assert (data["status_group"] == -1).all()
        assert data["status_at"].isnull().all()


def test_float32__is_stored_as_such_and_agrees_to_its_precision(result, tmp_path):
    single = run(tmp_path, GOOD.replace("positions = 48", 'positions = 48\nfield_precision = "float32"'))
    with h5py.File(single, "r") as file, h5py.File(result, "r") as double:
        for name in SCHEMA:
            field = name in ("ram.slide", "reduced_moment")
            assert file[name].dtype.str == ("<f4" if field else SCHEMA[name][0]), name
        assert file["status"][:].tolist() == [0, 0, 0, 0]
        # Some twenty roundings of 6e-8 on numbers of the size of the machine.
        np.testing.assert_allclose(file["ram.slide"][:], double["ram.slide"][:], rtol=0, atol=0.25 * 20 * 6e-8)
        for name in ("ram.stroke", "rocker.swing", "excess_work"):
            assert (abs(file[name][:] - double[name][:]) <= file[f"{name}_error"][:]).all(), name


# Variants that fail


def test_failing_variants__get_nan_a_verdict_and_the_place(tmp_path):
    lengths = ["50 mm", "240 mm", "210 mm", "-1 mm", "120 mm"]
    head = "positions = 48\nrequire = [\"bodies.ram.mass < '1e6 kg'\"]\n"
    path = run(tmp_path, text_of(lengths, ["1 kg", "2000 t", "-1 kg"], FIELDS, head))
    columns = SweepResult(path).columns
    status, V = columns["status"].reshape(5, 3), Verdict
    # 50 or 120 + 260 < 250 + 150: by Grashof's rule the crank turns fully. A crank of 210 mm or more doesn't.
    assert status[:, 0].tolist() == [V.OK, V.CANNOT_ASSEMBLE, V.CANNOT_ASSEMBLE, V.OUTSIDE_LIMITS, V.OK]
    assert status[:, 1:].tolist() == [[V.DROPPED, V.OUTSIDE_LIMITS]] * 5
    # Both texts name the numbers; the check can't know what fails to assemble, and drops what the run drops.
    told = counts_text(SweepResult(path)), check_text(read_study(tmp_path / "study.toml"), tmp_path / "other.h5")
    for text in told:
        assert "input.length: 2, such as -1 mm; must be > 0" in text
        assert "bodies.ram.mass: 5, such as -1 kg; must be ≥ 0" in text
    failed = columns["status"] != 0
    for name in ("ram.stroke", "rocker.swing", "excess_work"):
        assert np.isfinite(columns[name][~failed]).all()
        assert np.isnan(columns[name][failed]).all(), name
        assert np.isnan(columns[f"{name}_error"][failed]).all(), name
    assert not np.isnan(columns["input.length"]).any()
    with h5py.File(path, "r") as file:
        assert np.isfinite(file["ram.slide"][:][~failed]).all()
        assert np.isnan(file["ram.slide"][:][np.isin(columns["status"], (V.DROPPED, V.OUTSIDE_LIMITS))]).all()
    blamed = np.isin(columns["status"], (V.CANNOT_ASSEMBLE, V.SINGULAR))
    assert (columns["status_group"][~blamed] == -1).all()
    assert np.isnan(columns["status_at"][~blamed]).all()
    assert (columns["status_group"][blamed] >= 0).all()


def test_press_that_does_not_reach__is_blamed_at_the_first_angle(tmp_path):
    lengths = ["50 mm", "240 mm", "201 mm", "1 m"]
    path = run(tmp_path, text_of(lengths, ["1 kg"], STROKE, "positions = 720\n"))
    columns = SweepResult(path).columns
    assert columns["status"].tolist() == [0, 1, 1, 1]
    assert SweepResult(path).record["groups"][columns["status_group"][1]] == "press"
    # The rod of 200 mm reaches the guide until the pin is 200 mm above it: sin φ = 200/r.
    np.testing.assert_allclose(columns["status_at"][1:], np.arcsin(0.2 / np.array([0.24, 0.201, 1.0])), rtol=1e-9)


# What results don't depend on


def test_results__do_not_depend_on_blocks(monkeypatch, tmp_path):
    whole = run(tmp_path, DISTINCT, "whole")
    monkeypatch.setattr(runner, "block_size", lambda *_: 37)
    parts = run(tmp_path, DISTINCT, "parts")
    assert MappedResult(parts).done.size == 6
    assert MappedResult(whole).done.size < 4
    assert numbers_in(parts) == numbers_in(whole)


@each("seconds", [1e-9, 1e-5, 0.3, 20.0])
def test_block__is_a_second_of_work_within_memory(seconds, tmp_path):
    study = study_of(tmp_path, DISTINCT.replace("count = 200", "count = 1000000"))
    size = block_size(study, lambda: seconds)
    row = 8 * 48 * 2
    assert 1 <= size <= BYTES_PER_BLOCK / row
    assert size == 1 or size * seconds <= 1.0
    # Twice as many would take longer, or more memory.
    assert size * seconds > 0.4 or 4 * size * row > BYTES_PER_BLOCK or size == LARGEST_BLOCK
