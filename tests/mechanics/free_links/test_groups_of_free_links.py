"""Groups of free links: found by themselves, solved as 50 digits say, in the mode that the scene tells."""

import math

import numpy as np
import pytest
from commands import said
from driving_cams import changed
from each_case import refusals
from free_link_scenes import KINDS, free_link_scene, triad_data
from link_coordinates import LinkCoordinates
from machines import moving

from engine import AskError, Machine, MovingMachine, Near, Scene, SceneError, Verdict, assembly_modes
from engine.scene.structure.free_groups import cutting_of
from engine.scene.structure.ordering import order

# Structure


def only_group(data: dict):
    (group,) = order(Scene.model_validate(data)).free_groups.values()
    return group


@pytest.mark.parametrize(
    ("kind", "expected", "unknowns"),
    [
        ("three bars", (3, 3, 4, 6), 2),
        ("four-sided contour", (4, 2, 4, 6), 2),
        ("six-sided contour", (6, 3, 6, 9), 3),
    ],
)
def test_group__has_the_class_and_order_of_the_textbook(kind, expected, unknowns):
    group = only_group(KINDS[kind]())
    assert (group.group_class, group.order, len(group.links), len(group.pairs)) == expected
    assert len(cutting_of(group).placed) == unknowns


def test_class__depends_on_the_driven_link():
    # Stephenson III is a triad from this side, two dyads from the upper bar's.
    data = triad_data()
    data["input"] = {"type": "crank", "pivot": "Q", "pin": "D", "length": 0.2, "speed": "60 rpm", "link": "upper"}
    data["links"] = {
        "crank": {"joints": ["O", "A"], "length": 0.03},
        "rod": {"joints": ["A", "B"], "length": 0.2},
        "lower": {"joints": ["P", "C"], "length": 0.2},
        "plate": {"joints": ["D", "B"], "length": 0.1},
    }
    data["points"].pop("D"), data["points"].pop("B")
    data["points"]["C"] = {"link": "plate", "x": 0.05, "y": 0.08}
    data["bodies"], data["near"] = {}, {}
    groups = order(Scene.model_validate(data)).free_groups.values()
    assert [(g.group_class, set(g.links)) for g in groups] == [(2, {"lower", "plate"}), (2, {"crank", "rod"})]


test_links_that_make_no_group__are_refused_by_name = refusals(
    lambda changes: order(Scene.model_validate(changed(triad_data(), **changes))),
    ({"links__upper": None, "bodies__upper_body": None}, "moves too freely: rod, lower, plate … W = 3·3 − 2·4 = 1"),
    ({"links__brace": {"joints": ["P", "D"], "length": 0.2}}, "can't move … W = 3·1 − 2·2 = -1"),
    ({"links__rod__joints": ["O", "B"]}, "are joined to the frame only"),
)


# Positions, rates


def poses(scene: Scene, fields: dict, k: int) -> list[float]:
    """Coordinates of all free links at a position, from the fields of their points and angles."""
    found = []
    for name, link in scene.links.items():
        point = link.joints[0] if link.joints else next(p for p, part in scene.points.items() if part.link == name)
        part = scene.points.get(point) if not link.joints else None
        place = 0j if part is None else part.x + 1j * part.y
        if point in scene.points and scene.points[point].link == "frame":
            at = scene.points[point].x + 1j * scene.points[point].y
        else:
            at = fields[f"{point}.x"][k] + 1j * fields[f"{point}.y"][k]
        angle = fields[f"{name}.angle"][k]
        origin = at - place * np.exp(1j * angle)
        found += [origin.real, origin.imag, angle]
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_motion_of_every_kind_of_group__is_that_of_50_digits(kind):
    scene = free_link_scene(kind)
    (group,) = order(scene).free_groups
    parts = ("", "_phi", "_phiphi")
    moving = {*(p for p, part in scene.points.items() if part.link != "frame"), scene.input.pin}
    fields = [f"{name}.angle{part}" for name in scene.links for part in parts]
    fields += [f"{name}.{axis}" for name in sorted(moving) for axis in "xy"] + [f"{group}.certificate"]
    machine = MovingMachine(scene, positions=8)
    assert machine.verdict(fields) == Verdict.OK
    rows = machine.fields(fields)
    least = 0.05
    exact = LinkCoordinates(scene)
    for k in (1, 6):
        motion = exact.motion(poses(scene, rows, k), machine.q[k])
        for name in scene.links:
            for part, row in zip(parts, motion[name], strict=True):
                found = rows[f"{name}.angle{part}"][k]
                apart = (found - row[2] + math.pi) % (2 * math.pi) - math.pi if part == "" else found - row[2]
                # Rounding of a position, some 1e-15, is magnified by 1/quality in each derivative.
                assert abs(apart) < 1e-14 / least * max(1.0, abs(row[2]) / least)
    assert rows[f"{group}.certificate"].max() < 0.5


# Assembly modes


def count_by_scanning(data: dict) -> int:
    """Modes of the triad of three bars: the upper bar's angle is scanned, the plate follows from the lower bar."""
    points, links = data["points"], data["links"]

    def at(name: str) -> complex:
        return points[name]["x"] + 1j * points[name]["y"]

    angle = np.linspace(0.0, 2.0 * math.pi, 200001)
    d = at("Q") + links["upper"]["length"] * np.exp(1j * angle)
    count, pin = 0, data["input"]["length"] + 0j
    dc, db = at("C") - at("D"), at("B") - at("D")
    span = at("P") - d
    cosine = (abs(span) ** 2 + abs(dc) ** 2 - links["lower"]["length"] ** 2) / (2 * abs(span) * abs(dc))
    inside = np.abs(cosine) <= 1.0
    for side in (1, -1):
        turn = np.angle(span) + side * np.arccos(np.where(inside, cosine, 0.0)) - np.angle(dc)
        miss = np.where(inside, abs(d + db * np.exp(1j * turn) - pin) - links["rod"]["length"], np.nan)
        count += int(np.count_nonzero(miss[:-1] * miss[1:] < 0.0))
    return count


def test_modes__are_as_many_as_a_scan_finds():
    random, counts = np.random.default_rng(7), set()
    for _ in range(4):
        data = triad_data()
        for name in ("rod", "lower", "upper"):
            data["links"][name]["length"] *= random.uniform(0.7, 1.5)
        for name in "CD":
            for axis in "xy":
                data["points"][name][axis] = random.uniform(-0.3, 0.3)
        (modes,) = assembly_modes(Scene.model_validate(data)).values()
        assert len(modes) == count_by_scanning(data)
        counts.add(len(modes))
    assert counts == {0, 2, 4, 6}


def test_scene_that_tells_no_mode__is_refused_with_the_places():
    data = triad_data() | {"near": {}}
    with pytest.raises(SceneError, match=r"2 assembly modes .* near\.B = .* B may lie at"):
        Machine(Scene.model_validate(data), ["loop_closure_residual"]).evaluate({})


def in_mode(scene: Scene, mode) -> Scene:
    return scene.model_copy(update={"near": {name: Near(x=x, y=y) for name, (x, y) in mode.points.items()}})


def test_modes_that_meet__end_at_one_singular_place():
    scene = Scene.model_validate(KINDS["four-sided contour"]())
    (modes,) = assembly_modes(scene).values()
    assert len(modes) == 4
    places = []
    for mode in modes[1:3]:
        outcome = Machine(in_mode(scene, mode), ["loop_closure_residual"]).evaluate({})
        assert outcome.status[0] == Verdict.SINGULAR
        places.append(outcome.status_at[0])
    assert modes[1].transmission * modes[2].transmission < 0.0
    assert places[0] == pytest.approx(places[1], abs=1e-6)


def test_turn_that_ends_on_another_mode__has_its_verdict():
    data = triad_data() | {"bodies": {}, "near": {"D": {"x": -0.1436, "y": -0.117}}}
    places = {
        "P": (0.16118991452736542, -0.15871848211076536),
        "Q": (-0.019079077318118365, -0.06985801014958354),
        "B": (0.08142639717253887, 0.058049477547174835),
        "C": (-0.07656358429201503, 0.06432742463646056),
        "D": (0.08907119200760616, -0.04545682296800074),
    }
    for name, (x, y) in places.items():
        data["points"][name] |= {"x": x, "y": y}
    lengths = {"rod": 0.1502634300047681, "lower": 0.25412478894339685, "upper": 0.13317289919438757}
    for name, length in lengths.items():
        data["links"][name]["length"] = length
    data["input"]["length"] = 0.0424065209876992
    outcome = Machine(Scene.model_validate(data), ["loop_closure_residual"]).evaluate({})
    assert outcome.status[0] == Verdict.OTHER_MODE
    assert np.isnan(outcome.summaries["loop_closure_residual"][0])


def test_command__lists_the_modes_of_the_template(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert said("new", "triad").exit_code == 0
    listed = said("modes", "triad.toml", "--no-plots").output
    assert "group_of_plate: 2 real assembly modes" in listed
    assert listed.count("the scene's") == 1


# Sweeps


def test_sweep__follows_the_mode_of_its_scene():
    scene = free_link_scene("three bars")
    lengths = np.array([0.2, 0.22, 0.19, 0.6])
    path = "links.lower.length"
    fields = ["plate.angle", "C.x", "C.y"]
    swept = Machine(scene, fields=fields, varied=[path], positions=8).evaluate({path: lengths})
    assert swept.status.tolist() == [0, 0, 0, Verdict.MODE_NOT_REACHED]
    for i, length in enumerate(lengths[:3]):
        data = triad_data()
        data["links"]["lower"]["length"] = float(length)
        data["near"]["C"] = {"x": float(swept.fields["C.x"][i][0]), "y": float(swept.fields["C.y"][i][0])}
        alone = moving(data, fields[:1], 8)[1]["plate.angle"]
        assert swept.fields["plate.angle"][i] == pytest.approx(alone, abs=1e-13)


def test_place_that_tells_the_mode__is_not_varied():
    with pytest.raises(AskError, match=r"near\.C\.x selects the scene's assembly mode"):
        Machine(free_link_scene("three bars"), varied=["near.C.x"])
