"""Dyads and four-bar linkages through given positions of a plane, held to where the engine takes the plane."""

import cmath
import math
from pathlib import Path

import numpy as np
import pytest
from commands import refused, said
from each_case import refusals
from hypothesis import assume, example, given
from hypothesis import strategies as st

from engine import MovingMachine
from sweeps import read_scene
from sweeps.synthesis.dyads import PlaneDyad, PlanePosition, dyad_of_centre, dyad_of_circle, dyads_of_turn
from sweeps.synthesis.positioned import four_bar_through
from sweeps.synthesis.synthesis_error import SynthesisError

COORDINATES = st.builds(complex, st.floats(-1, 1), st.floats(-1, 1))
POSITIONS = st.builds(PlanePosition, COORDINATES, st.floats(-3, 3))


def radii(dyad, positions):
    return [abs(dyad.joint(place) - dyad.centre) for place in positions]


def spread(dyad, positions):
    """How far radii differ, against all lengths that go into them."""
    found = radii(dyad, positions)
    size = max(*found, abs(dyad.centre), abs(dyad.circle), 1.0)
    return (max(found) - min(found)) / size


@given(positions=st.lists(POSITIONS, min_size=3, max_size=3), joint=COORDINATES)
def test_dyad_through_three_positions__has_one_length(positions, joint):
    for make in (dyad_of_centre, dyad_of_circle):
        try:
            dyad = make(positions, joint)
        except SynthesisError:
            continue
        if make is dyad_of_centre:
            seen = [(joint - place.point) * cmath.exp(-1j * place.angle) for place in positions]
        else:
            seen = [place.point + joint * cmath.exp(1j * place.angle) for place in positions]
        # The circumcentre is a difference of products over the triangle's area, which loses digits where that is small.
        area = abs(((seen[1] - seen[0]).conjugate() * (seen[2] - seen[0])).imag)
        far = max(radii(dyad, positions)) + 3.0
        assert spread(dyad, positions) < 1e-14 * far**2 / area


def test_circle_point_and_centre_point__belong_to_each_other():
    positions = [PlanePosition(0j, 0.1), PlanePosition(0.04 + 0.025j, 0.4), PlanePosition(0.09 + 0.03j, 0.9)]
    dyad = dyad_of_centre(positions, -0.02 - 0.06j)
    assert dyad_of_circle(positions, dyad.circle).centre == pytest.approx(dyad.centre, abs=1e-14)


@given(positions=st.lists(POSITIONS, min_size=4, max_size=4), turn=st.floats(0.1, 6.2))
@example([PlanePosition(1e-170 * k * k + 2e-170j * k, 0.4 * k) for k in range(4)], 1.0)
def test_dyads_through_four_positions__have_one_length_and_turn_as_asked(positions, turn):
    for dyad in dyads_of_turn(positions, turn):
        first, second = (dyad.joint(place) - dyad.centre for place in positions[:2])
        size = max(abs(dyad.centre), abs(dyad.circle), abs(first))
        assume(size < 1e3)
        # What agrees less well is left out.
        assert spread(dyad, positions) < 4e-9
        assume(abs(first) > 1e-2)
        assert cmath.phase(second / first * cmath.exp(-1j * turn)) == pytest.approx(0.0, abs=1e-5)


def test_dyads_of_a_known_linkage__are_found_again():
    """A four-bar is taken through four positions by trigonometry; its own links lie on the curves of these."""
    a, b, c, frame, point = 0.06, 0.2, 0.14, 0.22, 0.1 + 0.05j
    positions, cranks = [], np.radians([20.0, 65.0, 110.0, 170.0])
    for crank in cranks:
        pin = cmath.rect(a, crank)
        to = frame - pin
        rocker_joint = pin + cmath.rect(
            b, cmath.phase(to) + math.acos((b * b + abs(to) ** 2 - c * c) / (2 * b * abs(to)))
        )
        along = (rocker_joint - pin) / b
        positions.append(PlanePosition(pin + point * along, cmath.phase(along)))
    found = dyads_of_turn(positions, cranks[1] - cranks[0])
    assert min(abs(dyad.centre) + abs(dyad.circle + point) for dyad in found) == pytest.approx(0.0, abs=1e-12)
    four_bar = four_bar_through(positions, PlaneDyad(0j, -point), PlaneDyad(frame + 0j, b - point))
    assert (four_bar.crank, four_bar.coupler, four_bar.rocker) == pytest.approx((a, b, c), rel=1e-13)
    assert (four_bar.turns, four_bar.mode) == (True, 1)
    assert four_bar.crank_angles == pytest.approx(cranks, abs=1e-13)
    assert four_bar.point == pytest.approx(point, abs=1e-14)
    # Crank and frame in line: the least angle of the triangle b, c, frame ± crank.
    ends = [abs((b * b + c * c - d * d) / (2 * b * c)) for d in (frame - a, frame + a)]
    assert four_bar.least_transmission == pytest.approx(math.acos(max(ends)), abs=1e-12)
    mixed = [positions[i] for i in (0, 2, 1, 3)]
    with pytest.raises(SynthesisError, match="would have to reverse"):
        four_bar_through(mixed, PlaneDyad(0j, -point), PlaneDyad(frame + 0j, b - point))


test_what_cannot_be_guided__is_refused_in_words = refusals(
    lambda make: make([PlanePosition(0j, 0.0), PlanePosition(0.04 + 0.025j, 0.3), PlanePosition(0.09 + 0.03j, 0.9)]),
    (lambda p: dyad_of_centre(p[:2], 0j), "needs three positions"),
    (lambda p: dyads_of_turn(p, 1.0), "four positions are needed"),
    (lambda p: dyad_of_circle([PlanePosition(complex(x), 0.0) for x in (0, 1, 2)], 0j), "collinear"),
    (lambda p: four_bar_through(p, *2 * [dyad_of_centre(p, -0.02 - 0.06j)]), "coincide"),
)


def test_linkages_with_defects__are_refused():
    """Of many linkages through the same positions some have each defect; those left pass through in one movement."""
    positions = [PlanePosition(0j, 0.0), PlanePosition(0.04 + 0.025j, 0.35), PlanePosition(0.09 + 0.03j, 0.87)]
    places = [complex(x, y) for x in np.linspace(-0.1, 0.15, 6) for y in np.linspace(-0.15, 0.1, 6)]
    said_of_them, sound = set(), 0
    for driven in places:
        for other in places:
            try:
                found = four_bar_through(positions, *(dyad_of_centre(positions, at) for at in (driven, other)))
            except SynthesisError as error:
                said_of_them.add(str(error).partition(":")[0])
                continue
            sound += 1
            assert walks(found, positions)
    assert sound > 10
    assert len(said_of_them) == 3, said_of_them


def walks(found, positions):
    """Whether, step by step from the first crank angle to the last, the linkage closes and comes to every position."""
    frame = found.rocker_pivot - found.crank_pivot
    angles = np.unique(
        np.concatenate([np.linspace(found.crank_angles[0], found.crank_angles[-1], 200), found.crank_angles])
    )
    pins = found.crank * np.exp(1j * angles)
    to = frame - pins
    inside = (found.coupler**2 + abs(to) ** 2 - found.rocker**2) / (2 * found.coupler * abs(to))
    along = to / abs(to) * np.exp(1j * found.mode * np.arccos(inside))
    points = found.crank_pivot + pins + found.point * along
    met = []
    for place, angle in zip(positions, found.crank_angles, strict=True):
        k = int(np.argmin(abs(angles - angle)))
        turned = cmath.phase(along[k] * cmath.exp(1j * (found.angle - place.angle)))
        met.append(abs(points[k] - place.point) < 1e-10 and abs(turned) < 1e-9)
    return bool((abs(inside) <= 1).all()) and all(met)


AT = ("0 mm, 0 mm, 0 deg", "40 mm, 25 mm, 20 deg", "90 mm, 30 mm, 50 deg", "120 mm, 10 mm, 75 deg")


def given_places(count):
    return [part for place in AT[:count] for part in ("--at", place)]


@pytest.mark.parametrize(("count", "links"), [(3, ("--pivot", "-20 mm, -60 mm", "--pivot", "100 mm, -80 mm")), (4, ())])
def test_command__writes_a_scene_that_passes_through_the_positions(tmp_path, monkeypatch, count, links):
    monkeypatch.chdir(tmp_path)
    answer = said("synthesise", "positions", *given_places(count), *links, "--out", "found.toml")
    assert answer.exit_code == 0, answer.output
    text = Path("found.toml").read_text()
    degrees = [float(part.split()[0].removesuffix(".")) for part in text.splitlines()[1].lstrip("# ").split(", ")]
    turned = float(text.splitlines()[2].partition(" by ")[2].split()[0])
    assert len(degrees) == count
    scene = read_scene("found.toml")
    for degree, place in zip(degrees, AT, strict=False):
        start = math.radians(degree)
        drive = scene.input.model_copy(update={"start": start, "stop": start + 1e-3})
        machine = MovingMachine(scene.model_copy(update={"input": drive}), positions=8)
        x, y, angle = (float(row[0]) for row in machine.fields(["P.x", "P.y", "coupler.angle"]).values())
        expected = [float(part.split()[0]) for part in place.split(",")]
        # A few roundings of lengths of at most 0.2 m and of their angles.
        assert [1e3 * x, 1e3 * y] == pytest.approx(expected[:2], abs=1e-10)
        off = angle + math.radians(turned - expected[2])
        assert math.remainder(off, 2 * math.pi) == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "three or four positions are needed, not 0"),
        (("--at", "1 mm, 2 mm"), "3 numbers are needed"),
        (("--at", "1 mm, 2 mm, 3 mm"), "angle"),
        ((*given_places(3), "--pivot", "0 mm, 0 mm"), "two links are needed"),
        ((*given_places(3), "--turn", "20 deg, 1", "--turn", "30 deg, 1"), "is for four positions"),
        ((*given_places(4), "--pivot", "0 mm, 0 mm"), "give --turn"),
        ((*given_places(4), "--turn", "20 deg, 3", "--turn", "30 deg, 1"), "1 and 2"),
    ],
)
def test_positions_that_do_not_fit__are_refused(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert words in refused("synthesise", "positions", *arguments)
    assert not list(tmp_path.iterdir())
