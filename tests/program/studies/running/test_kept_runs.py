"""Fields of runs in results: kept with their axes, the same however a study is cut, carried over, drawn, exported."""

import json

import h5py
import numpy as np
import pytest
from commands import refused, said
from motion_scenes import rotor, run

from engine import Scene
from sweeps import SweepResult, read_scene, read_study, run_study, write_scene
from sweeps.run import runner
from sweeps.store import MappedResult, read_columns

STUDY = """scene = "machine.toml"
positions = 240
[vary]
"bodies.eccentric.inertia" = { from = "0.3 kg m2", to = "0.5 kg m2", count = 5 }
[outputs]
summaries = ["go.time"]
fields = FIELDS
[best]
minimise = "go.time"
"""
FIELDS = ("go.speed", "go.turned", "reduced_inertia")


@pytest.fixture
def folder(tmp_path):
    # From rest under 3 N·m until 10 rad/s: I·10/3 s, between 1 s and 1.67 s.
    scene = rotor({"go": run("push", from_speed=0.0, speed=10.0, at={"times": "0 s to 1.5 s, 31"})})
    text = write_scene(Scene.model_validate(scene))
    assert text == write_scene(Scene.model_validate(scene))
    (tmp_path / "machine.toml").write_text(text, encoding="utf8")
    assert read_scene(tmp_path / "machine.toml") == Scene.model_validate(scene)
    return tmp_path


def study(folder, fields=FIELDS, text=STUDY):
    (folder / "study.toml").write_text(text.replace("FIELDS", json.dumps(list(fields))), encoding="utf8")
    return read_study(folder / "study.toml")


def test_rows__stand_in_the_file_with_their_axis_and_error_figure(folder, monkeypatch):
    path = run_study(study(folder), folder / "whole.h5")
    inertia, t = np.linspace(0.3, 0.5, 5)[:, None], 1.5 * np.arange(31) / 30
    with h5py.File(path) as file:
        speed = file["go.speed"]
        assert speed.dims[1].keys() == ["go.instant"]
        assert file["go.instant"].attrs["units"] == "s"
        assert speed.attrs["units"] == "rad s-1"
        assert np.array_equal(file["go.instant"][:], t)
        rows, error = speed[:], file["go.speed_error"][:]
    expected = np.where(3.0 * t / inertia <= 10.0 * (1.0 + 1e-12), 3.0 * t / inertia, np.nan)
    assert np.array_equal(np.isnan(rows), np.isnan(expected))
    assert (np.nanmax(np.abs(rows - expected), axis=1) <= error + 1e-15).all()
    described = MappedResult(path)
    assert described.axes["go.instant"]["count"] == 31
    assert SweepResult(path).along("go.turned").name == "go.instant"
    assert SweepResult(path).along("reduced_inertia").over_positions
    # Blocks of two variants give the same, to the last bit.
    monkeypatch.setattr(runner, "block_size", lambda *_: 2)
    cut = run_study(study(folder), folder / "cut.h5")
    for name in (*FIELDS, "go.speed_error", "go.turned_error"):
        assert np.array_equal(read_columns(path, [name])[name], read_columns(cut, [name])[name], equal_nan=True), name


def test_edited_study__takes_over_what_is_there(folder):
    path = run_study(study(folder, FIELDS[:1]), folder / "study.h5")
    before = read_columns(path, ["go.speed"])["go.speed"]
    told = []
    run_study(study(folder), path, tell=told.append)
    after = read_columns(path, [*FIELDS, "go.speed_error", "go.turned_error"])
    assert np.array_equal(before, after["go.speed"], equal_nan=True)
    assert np.isfinite(after["go.turned_error"]).all()
    whole = run_study(study(folder), folder / "whole.h5")
    for name, rows in after.items():
        assert np.array_equal(rows, read_columns(whole, [name])[name], equal_nan=True), name


def test_commands__draw_export_and_list_them(folder):
    path, rows = str(run_study(study(folder), folder / "study.h5")), str(folder / "rows.csv")
    assert "go.speed" in said("quantities", str(folder / "machine.toml"), "go.speed").stdout
    assert "fields over 31 values of go.instant: go.speed, go.turned" in said("show", path).stdout
    said("plot", path, "-y", "go.speed", "--out", str(folder / "speed.png"))
    assert (folder / "speed.png").stat().st_size > 10_000
    said("export", path, "--columns", "go.speed,go.turned", "--to", rows)
    lines = (folder / "rows.csv").read_text().splitlines()
    assert lines[0] == "variant,bodies.eccentric.inertia [kg m2],go.instant [s],go.speed [rpm],go.turned [deg]"
    assert len(lines) == 1 + 5 * 31
    words = refused("export", path, "--columns", "go.speed,reduced_inertia", "--to", rows)
    assert "have different axes (go.instant and phi)" in words
    assert "did you mean 'go.speed'" in refused("export", path, "--columns", "go.sped", "--to", rows)
