"""Drawings: symbols where the mechanism's geometry puts them, names that keep clear, files that are valid."""

import math
from xml.etree import ElementTree

import machines
import numpy as np
import pytest
from drawn_machines import (
    GALLERY,
    crank,
    four_bar,
    geared_five_bar,
    on_moving_guide,
    quick_return,
    scotch_yoke,
    slider_crank,
    sliding_input,
)
from each_case import each, refusals
from machines import frame, rrp
from matplotlib.figure import Figure

from engine import Scene
from sweeps import read_scene
from sweeps.pictures.drawing import LAYERS, DrawnMotion, draw, picture, position_text, primitives
from sweeps.pictures.drawing.figures import default_position, figures
from sweeps.pictures.drawing.frame import frame_parts, stands
from sweeps.pictures.drawing.guides import rails_of
from sweeps.pictures.drawing.racks import rack_shapes
from sweeps.pictures.drawing.symbols import HALF_LENGTH
from sweeps.pictures.picture_files import machine_pictures
from sweeps.pictures.style import save
from sweeps.text.scene_text import with_values
from sweeps.text.templates import bundled_templates

# Positions pass through a few dozen operations of the engine on lengths below 1 m.
EXACT = 1e-12


def circle(drawn, name):
    (found,) = [p for p in drawn if p.layer == "joints" and p.text == name]
    return found


def boxes(drawn):
    """Sliders and blocks: filled rectangles."""
    return [p for p in drawn if p.kind == "polygon" and len(p.points) == 4 and p.fill == "tint"]


def long_side(box):
    a, b, c, _ = box.points
    return b - a if abs(b - a) > abs(c - b) else c - b


def is_parallel(u, v):
    return abs((u.conjugate() * v).imag) < EXACT


@pytest.mark.parametrize("mode", [1, -1])
def test_stand__on_the_side_where_its_link_is_not(mode):
    """The rocker of a four-bar stays above its pivot or below it, by the mode of its group."""
    scene = four_bar()
    scene.groups["g"] = scene.groups["g"].model_copy(update={"mode": mode})
    motion = DrawnMotion(scene)
    hinge = motion.points["D"][0]
    (stand,) = [p for p in stands(motion) if p.kind == "polygon" and abs(p.points[0] - hinge) < EXACT]
    foot = (stand.points[1] + stand.points[2]) / 2 - hinge
    height = (motion.points["B"] - hinge).imag
    assert np.sign(foot.imag) == -mode
    assert (np.sign(height) == mode).all()


def of_slider(word, angle):
    """Corners of a slider's outlines from its joint, along the guide and across it, in hinge radii."""
    group = rrp("B", ("rod", "A", 0.2), word, "way")
    drawn = primitives(slider_crank(angle=angle, groups={"g": group}, bodies={}), 1.0)
    joint = circle(drawn, "B")
    turned = joint.size * complex(math.cos(angle), math.sin(angle))
    return [(np.array(p.points) - joint.points[0]) / turned for p in boxes(drawn)]


@pytest.mark.parametrize("angle", [0.0, 0.5, math.pi / 2, math.pi])
def test_sliders_by_name__ram_with_a_tool_in_front_table_and_trough_open_above(angle):
    # The guide leads from the crank; a guide to the left turns up and down over.
    upwards = -1 if math.isclose(angle, math.pi) else 1
    tool, ram = of_slider("press_ram", angle)
    assert tool.real.min() == pytest.approx(ram.real.max())
    assert tool.real.max() > ram.real.max() + 1
    foot, plate = of_slider("table", angle)
    assert np.ptp(plate.real) == pytest.approx(2 * np.ptp(foot.real))
    assert (upwards * plate.imag).max() == pytest.approx((upwards * foot.imag).max())
    assert (upwards * plate.imag).min() > 0
    _, bottom, left, right = of_slider("feed_trough", angle)
    assert (upwards * bottom.imag).max() < 0
    assert (left.real.min(), right.real.max()) == pytest.approx((bottom.real.min(), bottom.real.max()))
    assert (upwards * left.imag).max() > 1


@pytest.mark.parametrize("offset", [-0.08, 0.0, 0.08])
def test_guide__on_both_sides_of_the_slider_as_long_as_its_stroke(offset):
    drawn = primitives(slider_crank(offset=offset), 1.0)
    (block,) = boxes(drawn)
    faces = sorted({round(p.imag, 9) for p in block.points})
    rails = [p for p in drawn if p.layer == "frame" and p.kind == "line" and abs(p.points[0].imag - offset) > 1e-3]
    rails = [p for p in rails if abs(np.ptp(p.points)) > 0.1]
    assert sorted(p.points[0].imag for p in rails) == pytest.approx(faces)
    for rail in rails:
        # The stroke is 2r for a guide through O and longer for any other.
        assert np.ptp(np.real(rail.points)) > 2 * 0.05 + 2 * HALF_LENGTH * circle(drawn, "B").size
        assert np.ptp(np.imag(rail.points)) < EXACT


@pytest.mark.parametrize("offset", [0.0, 0.08, -0.14])
def test_hatching_of_guides__is_crossed_by_no_link_at_any_position(offset):
    motion = DrawnMotion(slider_crank(offset=offset))
    (slider,) = motion.sliders
    strokes = [p.points for p in rails_of(motion, slider).figures if p.layer == "hatching"]
    assert strokes
    for k in range(0, 720, 7):
        o, a, b = (complex(motion.points[name][k]) for name in "OAB")
        assert not [stroke for stroke in strokes if crosses(*stroke, o, a) or crosses(*stroke, a, b)]


def crosses(a, b, c, d):
    """Whether the lines a – b and c – d cross."""

    def side(p, q, r):
        return np.sign(((q - p).conjugate() * (r - p)).imag)

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def test_cylinder__has_a_head_beyond_the_stroke_and_two_valves():
    scene = read_scene(bundled_templates()["slider_crank"])
    pump = {"type": "pump", "piston": "piston", "bore": 0.06, "suction": 9e4, "discharge": 8e5}
    motion = DrawnMotion(Scene.model_validate(scene.model_dump(exclude_unset=True) | {"cylinders": {"liquid": pump}}))
    plain = DrawnMotion(scene)
    head = [p for p in frame_parts(motion) if p.kind == "line" and p.layer == "frame" and is_upright(p)]
    assert not [p for p in frame_parts(plain) if p.kind == "line" and p.layer == "frame" and is_upright(p)]
    (at,) = {round(p.points[0].real, 9) for p in head}
    # The crank is 40 mm, the rod 160 mm.
    assert 0.2 < at < 0.24
    valves = [p for p in frame_parts(motion) if p.layer == "links"]
    assert [p.points[0].real for p in valves] == pytest.approx([at, at])
    assert valves[0].points[0].imag == pytest.approx(-valves[1].points[1].imag)


def is_upright(figure):
    return np.ptp(np.real(figure.points)) < EXACT < np.ptp(np.imag(figure.points))


def test_link_of_three_points__polygon_through_them():
    drawn = primitives(four_bar(), 1.0)
    (plate,) = [p for p in drawn if p.kind == "polygon" and p.layer == "links"]
    corners = [circle(drawn, name).points[0] for name in "ABP"]
    assert all(min(abs(c - p) for p in plate.points) < EXACT for c in corners)
    assert abs(corners[0] - corners[1]) == pytest.approx(0.2)
    assert circle(drawn, "P").fill == "solid"
    assert circle(drawn, "B").fill == "paper"


@pytest.mark.parametrize("offset", [0.0, 0.05])
def test_rocker__line_through_its_pivot_and_block_on_it(offset):
    drawn = primitives(quick_return(offset), 1.0)
    d, a = circle(drawn, "D").points[0], circle(drawn, "A").points[0]
    (block,) = [b for b in boxes(drawn) if abs(sum(b.points) / 4 - a) < 1.01 * offset + EXACT]
    foot = sum(block.points) / 4
    assert is_parallel(long_side(block), foot - d)
    # The block's pivot lies at the offset to the left of the slot.
    assert ((a - d) * (foot - d).conjugate()).imag / abs(foot - d) == pytest.approx(offset, abs=EXACT)
    rods = [p for p in drawn if p.kind == "line" and p.layer == "links" and is_parallel(np.ptp(p.points), foot - d)]
    assert max(abs(p.points[1] - p.points[0]) for p in rods) > abs(foot - d)


def test_yoke__slot_across_its_guide_and_round_the_block():
    scene = scotch_yoke()
    for phi in (0.0, 1.0, 2.5, 4.0):
        drawn = primitives(scene, phi)
        (slot,) = [p for p in drawn if p.layer == "links" and p.fill == "paper"]
        along = complex(math.cos(0.3), math.sin(0.3))
        assert is_parallel(long_side(slot), 1j * along)
        (block,) = boxes(drawn)
        reach = [((p - sum(slot.points) / 4) / long_side(slot)).real for p in block.points]
        assert max(map(abs, reach)) < 0.5
        assert abs(sum(block.points) / 4 - circle(drawn, "A").points[0]) < EXACT


def test_slider_on_moving_guide__sleeve_turned_with_its_carrier():
    drawn = primitives(on_moving_guide(), 1.0)
    d, b, f = (circle(drawn, name).points[0] for name in "DBF")
    along = (b - d) / abs(b - d) * complex(math.cos(0.2), math.sin(0.2))
    (sleeve,) = boxes(drawn)
    assert abs(sum(sleeve.points) / 4 - f) < EXACT
    assert is_parallel(long_side(sleeve), along)
    assert sum(p.fill == "solid" and p.layer == "links" for p in drawn) == 2


def test_gears__pitch_circles_touch_in_the_ratio_of_speeds():
    drawn = primitives(geared_five_bar(ratio=-2.0), 1.0)
    one, two = [p for p in drawn if p.layer == "pitch"]
    assert one.size + two.size == pytest.approx(0.16)
    assert one.size / two.size == pytest.approx(2.0)


def test_belt__tangent_to_both_pulleys():
    drawn = primitives(geared_five_bar(ratio=0.5), 1.0)
    wheels = [p for p in drawn if p.layer == "pitch" and p.kind == "circle"]
    straps = [p for p in drawn if p.layer == "pitch" and p.kind == "line"]
    assert wheels[0].size / wheels[1].size == pytest.approx(0.5)
    for strap in straps:
        for wheel, end in zip(wheels, strap.points, strict=True):
            arm = end - wheel.points[0]
            assert abs(arm) == pytest.approx(wheel.size)
            assert abs((arm.conjugate() * np.ptp(strap.points)).real) < EXACT


@pytest.mark.parametrize("speed", [6.0, -6.0])
def test_arrow_of_crank__turns_as_the_speed_says(speed):
    drawn = primitives(slider_crank(input=crank(speed=speed)), 0.0)
    (arc,) = [p for p in drawn if p.layer == "names" and p.kind == "line"]
    assert np.all(np.diff(np.unwrap(np.angle(arc.points))) * speed > 0)


def with_second_inputs(speed):
    """A crank that drives a four-bar, and beside it a swinging crank, and a slide that rests for a half turn."""
    scene = four_bar().model_dump(exclude_none=True)
    scene["points"] |= {"S": {"x": 0.1, "y": -0.1}, "T": {"link": "swing", "x": 0.0, "y": 0.06}}
    sections = {
        "out": {"type": "rise", "law": "cycloidal", "angle": math.pi / 2, "lift": 0.05},
        "stay": {"type": "dwell", "angle": math.pi},
        "back": {"type": "return", "law": "cycloidal"},
    }
    swing = {"type": "crank", "pivot": "S", "harmonics": {"one": {"order": 1, "sine": 0.4}}}
    inputs = {"swing": swing, "ram": {"type": "slider", "guide": "way", "sections": sections}}
    guides = {"way": {"y": -0.2, "angle": 0.3}}
    return Scene.model_validate(scene | {"input": crank(speed=speed), "guides": guides, "inputs": inputs})


@pytest.mark.parametrize("speed", [6.0, -6.0])
def test_arrows_of_second_inputs__ahead_of_them_by_the_laws_and_none_at_rest(speed):
    scene = with_second_inputs(speed)
    # Swing 0.4 sin φ; the slide goes out, rests, and comes back.
    for phi, slides in ((0.7, 1), (2.5, 0), (5.5, -1)):
        drawn = primitives(scene, phi)
        _, arc, *shafts = [np.array(p.points) for p in drawn if p.layer == "names" and p.kind == "line"]
        about = arc - complex(0.1, -0.1)
        turned = np.unwrap(np.angle(about / (circle(drawn, "T").points[0] - complex(0.1, -0.1))))
        sense = math.copysign(1.0, math.cos(phi) * speed)
        assert np.ptp(np.abs(about)) < EXACT
        assert sense * turned[0] == pytest.approx(0.25)
        assert np.all(sense * np.diff(turned) > 0)
        assert len(shafts) == abs(slides)
        for tail, tip in shafts:
            along = (tip - tail) * np.exp(-0.3j)
            assert abs(along.imag) < EXACT
            assert along.real * slides * speed > 0


def test_paths__closed_curve_and_a_to_and_fro_drawn_once():
    drawn = primitives(four_bar(), 1.0, paths=["P", "B"])
    loop, arc = (np.array(p.points) for p in drawn if p.layer == "paths")
    assert loop[0] == loop[-1]
    assert loop.size == 721
    assert np.abs(arc - (0.22 + 0.01j)) == pytest.approx(0.15)
    # Reversed steps would make the way longer than the arc between its ends.
    turned = np.ptp(np.angle(arc - (0.22 + 0.01j)))
    assert np.abs(np.diff(arc)).sum() == pytest.approx(0.15 * turned, rel=1e-4)


@each("name", GALLERY)
def test_names__every_point_named_and_no_name_on_another(name):
    scene = GALLERY[name]
    motion = DrawnMotion(scene)
    drawn = primitives(scene, motion.q[100])
    texts = [p for p in drawn if p.kind == "text"]
    assert {t.text for t in texts} >= motion.hinges
    for i, one in enumerate(texts):
        for two in texts[:i]:
            gap = one.points[0] - two.points[0]
            assert max(abs(gap.real) / 0.7, abs(gap.imag)) > 0.9 * one.size
    for joint in (p for p in drawn if p.layer == "joints" and p.kind == "circle"):
        for text in texts:
            assert abs(text.points[0] - joint.points[0]) > joint.size


@each("name", GALLERY)
def test_primitives__finite_in_known_layers_convex_and_stands_never_under_plates(name):
    motion = DrawnMotion(GALLERY[name])
    for k in (0, 240, 600):
        drawn = primitives(GALLERY[name], motion.q[k])
        feet = [i for i, p in enumerate(drawn) if p.kind == "polygon" and p.layer == "frame"]
        plates = [i for i, p in enumerate(drawn) if p.kind == "polygon" and p.fill == "tint"]
        assert min(feet, default=len(drawn)) > max(plates, default=-1)
        for p in drawn:
            assert p.layer in LAYERS
            assert np.isfinite(p.points).all()
            if p.kind == "polygon":
                sides = np.diff(np.array([*p.points, *p.points[:2]]))
                turns = (sides[:-1].conj() * sides[1:]).imag
                assert (turns > 0).all() or (turns < 0).all()


LOCKING = {"groups.g.first.length": 0.1, "groups.g.second.length": 0.1}
test_what_cannot_be_drawn__is_refused = refusals(
    lambda drawn: drawn(),
    (lambda: primitives(four_bar(), 0.0, paths=["Q"]), "'Q' is not a point … : A, B, D, O, P"),
    (lambda: primitives(sliding_input(), 0.2), "200 mm is outside the input's range 0 mm to 120 mm"),
    (lambda: annotated(slider_crank(), 1.0, "mass"), "'mass' can't be shown … mean 'masses'"),
    (
        lambda: primitives(with_values(four_bar(), LOCKING), 3.1),
        "position 177 … can't be drawn: a group can't be assembled",
    ),
    (
        lambda: primitives(with_values(four_bar(), {"groups.g.first.length": 0.001}), 0.0),
        "undefined at every position",
    ),
)


def test_machine_that_assembles_in_part__is_drawn_where_it_does_without_diagrams(tmp_path):
    short = with_values(slider_crank(), {"groups.g.first.length": 0.03})
    crank = float(DrawnMotion(short).numbers["input.length"])
    reach = math.degrees(math.asin(0.03 / crank))
    assert 0 < reach < 60
    # Of 720 nodes, the last at which it assembles.
    drawn = default_position(DrawnMotion(short))
    assert math.degrees(drawn) == pytest.approx(reach - reach % 0.5)
    title = picture(short).axes[0].get_title("left")
    assert "assembles only for input" in title
    assert position_text(short, drawn).replace(" ", "\xa0") in title
    assert machine_pictures(short, tmp_path / "m.svg") == [tmp_path / "m.svg"]


def test_draw__first_position_black_others_light_axes_equal():
    axes = Figure().add_subplot()
    draw(four_bar(), axes, at=[1.0, 2.0, 3.0])
    inks = {patch.get_edgecolor()[:3] for patch in axes.patches}
    assert len(inks) == 2
    assert (0.0, 0.0, 0.0) in inks
    assert axes.get_aspect() == 1
    assert axes.get_xlabel() == "x, mm"
    assert axes.get_xlim()[1] > 220


@pytest.mark.parametrize("ending", ["svg", "pdf", "png"])
def test_picture__valid_and_the_same_every_time(ending, tmp_path):
    files = [tmp_path / f"{n}.{ending}" for n in (1, 2)]
    for file in files:
        save(picture(four_bar(), at=[1.0], paths=["P"]), file)
    assert files[0].read_bytes() == files[1].read_bytes()
    if ending == "svg":
        root = ElementTree.parse(files[0]).getroot()
        assert root.tag.endswith("svg")
        assert "φ\xa0=\xa057.296°" in {text.text for text in root.iter("{http://www.w3.org/2000/svg}text")}
    else:
        assert files[0].read_bytes()[:4] == {"pdf": b"%PDF", "png": b"\x89PNG"}[ending]


def annotated(scene, phi, *kinds):
    """What is drawn more of a scene where so many kinds of things are shown, and the texts among it."""
    motion = DrawnMotion(scene)
    plain, full = figures(motion, [phi])[-1], figures(motion, [phi], shown=kinds)[-1]
    more = [p for p in full if p not in plain]
    return more, {p.text: p for p in more if p.kind == "text"}


RAM = {"load": {"type": "constant", "on": "B", "angle": math.pi, "force": 250.0}}
HALVED = {"rod_body": {"link": "rod", "mass": 1.0, "x": 0.05, "y": 0.01}}


def test_centres_of_mass__lie_on_their_links():
    phi = math.pi / 3
    more, texts = annotated(slider_crank(bodies=HALVED), phi, "masses")
    pin = 0.05 * complex(math.cos(phi), math.sin(phi))
    end = pin.real + math.sqrt(0.2**2 - pin.imag**2)
    u = (end - pin) / 0.2
    (disc,) = [p for p in more if p.kind == "circle"]
    assert disc.points[0] == pytest.approx(pin + (0.05 + 0.01j) * u, abs=EXACT)
    assert not texts


def test_forces__point_where_they_push_with_their_magnitude():
    more, texts = annotated(slider_crank(forces=RAM), 1.1, "forces")
    (head,) = [p for p in more if p.kind == "polygon"]
    (shaft,) = [p for p in more if p.kind == "line"]
    along = np.diff(shaft.points)[0]
    assert is_parallel(along / abs(along), 1)
    assert along.real < 0
    assert head.points[0].real < shaft.points[0].real
    assert set(texts) == {"load = 250 N"}


def test_links__named_and_no_name_on_another():
    _, texts = annotated(slider_crank(bodies=HALVED), 1.1, "links", "masses")
    assert set(texts) == {"crank", "rod", "piston"}
    boxes_of_texts = [(p.points[0], complex(0.36 * len(p.text), 0.5) * p.size) for p in texts.values()]
    for i, (one, half) in enumerate(boxes_of_texts):
        for two, other in boxes_of_texts[:i]:
            gap, room = one - two, half + other
            assert abs(gap.real) > room.real or abs(gap.imag) > room.imag


def test_scale__is_that_of_the_paper():
    figure = picture(four_bar(), at=[1.0], shown=["scale"])
    (ax,) = figure.axes
    figure.draw_without_rendering()
    # 100 mm in nature on the axes, in dots on paper.
    (left, _), (right, _) = ax.transData.transform([(0, 0), (100, 0)])
    told = float(ax.get_title(loc="left").rpartition("scale 1 : ")[2])
    assert told == pytest.approx(100 / ((right - left) / figure.dpi * 25.4), rel=5e-3)


# Racks


def along_bar(scene, points):
    """Where a rack's bar ends along the guide, and where some points of its link are, in a mechanism on the x axis."""
    motion = DrawnMotion(scene)
    k = motion.node(1.0)
    bar = next(p for p in rack_shapes(motion, k) if p.kind == "polygon")
    found = [complex(motion.points[name][k]) for name in points]
    return [corner.real for corner in bar.points], found


def test_rack_that_a_slider_carries__reaches_from_its_stem_to_the_pinion():
    # The pinion's axis stands far ahead of all places of the slider.
    pinion = {"rack": "ram", "pivot": "C", "radius": 0.03}
    points = {"O": frame(0.0, 0.0), "C": frame(0.6, 0.05)}
    scene = Scene.model_validate(machines.slider_crank(points=points, pinions={"wheel": pinion}))
    bar, (joint,) = along_bar(scene, "B")
    assert min(bar) < joint.real < max(bar)
    assert min(bar) < 0.6 < max(bar)


def test_path_that_is_wanted__is_drawn_with_its_places():
    places = [complex(0.03, 0.05), complex(0.0, 0.02)]
    wish = {"type": "path", "point": "B", "x": [z.real for z in places], "y": [z.imag for z in places]}
    scene = Scene.model_validate(machines.four_bar() | {"wanted": {"it": wish}})
    motion = DrawnMotion(scene)
    drawn = figures(motion, [1.0])[-1]
    dots = [p.points[0] for p in drawn if p.layer == "paths" and p.kind == "circle"]
    assert dots == places
    (trail,) = [p for p in drawn if p.layer == "paths" and p.kind == "line"]
    assert set(trail.points) <= set(motion.points["B"])
