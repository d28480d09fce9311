"""Cams in scenes: what is refused and how, copies of their texts, pictures and exports."""

import csv
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from cam_samples import ARM, CAMS, FLAT, KNIFE, ROLLER, cam_of, cam_scene
from commands import refused, said
from each_case import refusals

from engine import Scene, cam_curves
from sweeps.pictures.elements.element_pictures import element_sheet
from sweeps.pictures.picture_error import PictureError
from sweeps.text.scene_text import read_scene, write_scene

test_cam_that_cannot_be__is_refused_with_a_mend = refusals(
    lambda cam, changes: cam_scene(cam, **changes),
    (ROLLER, {"sections__out__angle": "300 deg"}, "add up to 450 deg: nothing is left"),
    (ROLLER, {"sections__low__angle": "100 deg"}, "add up to 350 deg, not to 360 deg; leave out one"),
    (ROLLER, {"sections__rest": {"type": "dwell"}}, "only one section may omit it"),
    (ROLLER, {"sections__back__lift": "10 mm"}, "0.01 away from where it began; add a return"),
    (ROLLER, {"sections__out__lift": None}, "sections.out.lift is missing"),
    (ROLLER, {"sections__out__swing": "5 deg"}, "this link slides; give lift instead"),
    (ARM, {"sections__out__lift": "5 mm"}, "this link turns; give swing instead"),
    (
        ROLLER,
        {"sections__out__law": "sine"},
        "allowed: uniform, parabolic, harmonic, cycloidal, 3-4-5, 4-5-6-7, modified sine",
    ),
    (ROLLER, {"sections": {}}, "give sections, or a table"),
    (ROLLER, {"follower__roller_radius": None}, "roller_radius is missing: contact = 'roller' needs it"),
    (KNIFE, {"closure": "form"}, "give contact = 'roller'"),
    (KNIFE, {"line_contact": {"width": "5 mm"}}, "line_contact"),
    (FLAT, {"limits": {"pressure_angle": "30 deg"}}, "a flat face has none"),
    (ARM, {"follower__arm": None}, "arm is missing"),
    (ROLLER, {"follower__friction": 0.1}, "give all, or none"),
    (
        FLAT,
        {"sections": None, "table": {"over_angle": ["0 deg", "90 deg", "80 deg"], "lift": ["0 mm"] * 3}},
        "sort the rows",
    ),
)


@pytest.mark.parametrize("name", CAMS)
def test_scene_text_of_a_cam__reads_as_the_same_scene(name, tmp_path):
    scene = cam_scene(CAMS[name])
    path = tmp_path / "scene.toml"
    path.write_text(write_scene(scene, {"elements.cam.base_radius": 0.05}), encoding="utf8")
    again = read_scene(path)
    assert again.elements["cam"].base_radius == 0.05
    assert again.elements["cam"].sections == scene.elements["cam"].sections


def test_cam_that_cannot_be_placed__is_not_drawn():
    with pytest.raises(PictureError, match="no results to draw"):
        element_sheet(cam_of(ROLLER, follower__offset="39 mm"))


@pytest.fixture
def template(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said("new", "cam")
    return "cam.toml"


def test_exported_outlines__are_the_profile(template):
    cam = read_scene(template).elements["cam"]
    curves = cam_curves(cam, 3600)
    for ending in ("csv", "svg", "dxf"):
        assert f"Wrote cam.{ending}" in said("export", template, "--to", f"cam.{ending}").output
    with Path("cam.csv").open(encoding="utf8") as file:
        rows = list(csv.DictReader(file))
    profile = np.array([complex(float(r["profile_x [mm]"]), float(r["profile_y [mm]"])) for r in rows]) / 1e3
    angles = np.radians([float(row["angle [deg]"]) for row in rows])
    true = np.interp(angles, curves.angle, np.abs(curves.profile))
    np.testing.assert_allclose(np.abs(profile), true, rtol=1e-9)
    # Of the section ends, where nothing jumps but the jerk, each has one row or two.
    assert len(curves.angle) - 10 <= len(rows) <= len(curves.angle)
    paths = {p.get("id"): p.get("d") for p in ET.parse("cam.svg").getroot()}
    assert set(paths) == {"profile", "pitch", "cutter", "axis"}
    drawn = np.array([complex(*map(float, p.split(","))) for p in paths["profile"][1:-1].split()]).conj() / 1e3
    assert np.abs(drawn - profile[0]).min() < 1e-9
    assert np.abs(drawn).min() == pytest.approx(cam.base_radius, abs=1e-9)
    assert np.abs(drawn).max() == pytest.approx(np.abs(curves.profile).max(), abs=1e-9)


def test_exported_dxf__has_closed_outlines_in_millimetres(template):
    ezdxf = pytest.importorskip("ezdxf")
    said("export", template, "--to", "cam.dxf")
    lines = {line.dxf.layer: line for line in ezdxf.readfile("cam.dxf").modelspace().query("LWPOLYLINE")}
    assert set(lines) == {"profile", "pitch", "cutter"}
    for name, least in (("profile", 30.0), ("pitch", 40.0), ("cutter", 50.0)):
        assert lines[name].closed
        assert min(math.hypot(x, y) for x, y in lines[name].get_points("xy")) == pytest.approx(least, abs=1e-6)
    Path("inches.toml").write_text(f'units = "US"\n{Path(template).read_text(encoding="utf8")}', encoding="utf8")
    said("export", "inches.toml", "--to", "inches.dxf")
    (profile,) = ezdxf.readfile("inches.dxf").modelspace().query("LWPOLYLINE[layer=='profile']")
    assert min(math.hypot(x, y) for x, y in profile.get_points("xy")) == pytest.approx(30 / 25.4, abs=1e-6)


def test_element_that_is_no_cam__is_refused(template):
    assert "name a cam of this scene: cam" in refused("export", template, "--to", "x.csv", "--element", "cm")


def test_cams_of_a_scene_with_several__are_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = Scene.model_validate({"elements": {"inlet": FLAT, "outlet": ROLLER}})
    Path("two.toml").write_text(write_scene(scene), encoding="utf8")
    assert "name a cam of this scene: inlet, outlet" in refused("export", "two.toml", "--to", "x.svg")
    assert "Wrote x.svg" in said("export", "two.toml", "--to", "x.svg", "--element", "inlet").output


def test_plot_of_a_scene_with_a_cam__is_its_sheet(template):
    assert "cam_cam.png" in said("plot", template).output
