"""DXF: layers, millimetres, and hidden lines left out."""

import json
import math
import os
import subprocess
import sys

import ezdxf
import numpy as np
import pytest
from drawn_machines import GALLERY, slider_crank
from driving_cams import CIRCLE, SLIDING, changed

from engine import Scene, show_system
from sweeps.pictures.drawing import DrawnMotion, primitives
from sweeps.pictures.drawing.dxf import write_dxf
from sweeps.pictures.picture_error import PictureError

# Positions pass through a few dozen operations of the engine on lengths below 1 m.
EXACT = 1e-12


def test_dxf__layers_millimetres_and_joints_in_place(tmp_path):
    file, phi = tmp_path / "a.dxf", math.pi / 3
    scene = slider_crank(wanted={"w": {"type": "path", "point": "B", "x": [0.1, 0.2], "y": [0.0, 0.0]}})
    write_dxf(file, scene, phi)
    document = ezdxf.readfile(file)
    assert {p.layer for p in primitives(scene, phi)} <= {layer.dxf.name for layer in document.layers}
    assert document.units == ezdxf.units.MM
    space = document.modelspace()
    for layer in ("links", "joints", "frame", "paths", "names"):
        assert space.query(f"*[layer=='{layer}']"), layer
    centres = [complex(*c.dxf.center.xyz[:2]) for c in space.query("CIRCLE[layer=='joints']")]
    pin = 50 * complex(math.cos(phi), math.sin(phi))
    assert min(abs(c - pin) for c in centres) < 1000 * EXACT
    assert {t.dxf.text for t in space.query("TEXT")} == {"O", "A", "B"}


def test_dxf__of_an_american_scene_is_in_inches(tmp_path):
    show_system("US")
    write_dxf(tmp_path / "a.dxf", slider_crank(), 0.0)
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert document.units == ezdxf.units.IN
    centres = [complex(*c.dxf.center.xyz[:2]) for c in document.modelspace().query("CIRCLE[layer=='joints']")]
    # A crank of 50 mm.
    assert min(abs(c - 50 / 25.4) for c in centres) < EXACT


@pytest.mark.parametrize("name", GALLERY)
def test_dxf__no_link_seen_through_a_hinge(name, tmp_path):
    file = tmp_path / "a.dxf"
    scene = GALLERY[name]
    write_dxf(file, scene, DrawnMotion(scene).q[120])
    space = ezdxf.readfile(file).modelspace()
    drawn = []
    for figure in space.query("LINE LWPOLYLINE[layer=='links' | layer=='frame' | layer=='hatching']"):
        lines = [figure] if figure.dxftype() == "LINE" else figure.virtual_entities()
        drawn += [(complex(*line.dxf.start.xyz[:2]), complex(*line.dxf.end.xyz[:2])) for line in lines]
    for hinge in space.query("CIRCLE[layer=='joints']"):
        centre, radius = complex(*hinge.dxf.center.xyz[:2]), hinge.dxf.radius
        for a, b in drawn:
            share = np.clip((((centre - a) / (b - a)).real), 0, 1)
            # Circles hide by the polygon of 24 sides inside them, which leaves 1 − cos 7.5° = 0.9 % of the radius.
            assert abs(a + share * (b - a) - centre) > 0.99 * radius


def test_cam_in_a_mechanism__is_one_closed_outline(tmp_path):
    """An eccentric circle of 50 mm, its centre 20 mm from the crank's axis and away from the face at φ = 0."""
    file, phi = tmp_path / "a.dxf", math.pi / 3
    flat = {"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"}
    machine = changed(SLIDING, cams__cam__sections=CIRCLE, cams__cam__follower=flat)
    write_dxf(file, Scene.model_validate(machine), phi)
    (outline,) = (p for p in ezdxf.readfile(file).modelspace().query("LWPOLYLINE[layer=='links']") if p.closed)
    points = np.array([complex(x, y) for x, y in outline.get_points("xy")])
    centre = -20j * complex(math.cos(phi), math.sin(phi))
    np.testing.assert_allclose(np.abs(points - centre), 50.0, atol=1000 * EXACT)
    assert abs(np.angle((np.roll(points, -1) - centre) / (points - centre)).sum()) == pytest.approx(math.tau)


def test_dxf_without_its_package__says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(PictureError, match=r"pip install 'machine-sweeps\[dxf\]'"):
        write_dxf(tmp_path / "a.dxf", slider_crank(), 0.0)


def test_garbled_list_of_fonts__is_made_again(tmp_path):
    fonts = tmp_path / "ezdxf" / "font_manager_cache.json"
    fonts.parent.mkdir()
    fonts.write_bytes(b"\xae" * 40)
    command = "from sweeps.pictures.drawing.dxf import new_document; print(new_document().units)"
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    ended = subprocess.run([sys.executable, "-c", command], env=environment, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout.strip()) == (0, str(int(ezdxf.units.MM))), ended.stderr
    assert json.loads(fonts.read_text("utf8"))
