"""Shaking force and moment against the frame's reaction, and closed forms of their orders."""

import math

import mpmath as mp
import numpy as np
import pytest
from drawn_machines import sliding_input
from each_case import refusals
from machines import changed, crank, frame, moving, rpr, slider_crank
from oracle import EPS
from press import bodies, press

from engine import Machine, Scene

SHAKING = ["shaking_force_x", "shaking_force_y", "shaking_moment"]
# The motions' harmonics fall below rounding before half of it.
POSITIONS = 256
SPEED = 5.0


def body(link: str, mass: float, x: float, y: float, inertia: float) -> dict:
    return {"link": link, "mass": mass, "x": x, "y": y, "inertia": inertia}


def six_bar() -> dict:
    """A press with a body on every link, shafts geared to crank and rocker, everything off its axis."""
    return press(bodies=bodies()) | {"gravity": 0.0}


def swinging_block() -> dict:
    """Crank and slotted lever."""
    return {
        "points": {"O": frame(0.0, 0.0), "D": frame(0.2, -0.9)},
        "input": crank(speed=-SPEED),
        "groups": {"g": rpr(("block", "A"), ("lever", "D"), 0.03)},
        "bodies": {"a": body("block", 0.8, 0.02, 0.01, 0.05), "b": body("lever", 2.5, 0.7, -0.05, 0.4)},
    }


MACHINES = {"six bars": six_bar(), "slotted lever": swinging_block()}


@pytest.mark.parametrize("name", MACHINES)
def test_shaking__is_what_the_frame_bears_without_loads(name):
    fields = [*SHAKING, "frame.reaction_x", "frame.reaction_y", "frame.reaction_moment"]
    _, rows = moving(MACHINES[name] | {"balance": {"about": "D"}}, fields, 16)
    fx, fy, moment, rx, ry, about_origin = (rows[field] for field in fields)
    x, y = (MACHINES[name]["points"]["D"][axis] for axis in ("x", "y"))
    forces = np.abs(fx).max() + np.abs(fy).max()
    # Sums of some twenty terms, of the size of the greatest reactions: a few times what is left of them.
    np.testing.assert_allclose(fx, rx, rtol=0, atol=256 * EPS * forces)
    np.testing.assert_allclose(fy, ry, rtol=0, atol=256 * EPS * forces)
    size = forces + np.abs(about_origin).max()
    np.testing.assert_allclose(moment + x * fy - y * fx, about_origin, rtol=0, atol=256 * EPS * size)


def test_shaking_moment__is_about_the_inputs_pivot_or_the_named_point():
    field = Machine(Scene.model_validate(six_bar())).available_fields["shaking_moment"]
    assert "about O at" in field.long_name
    named = Machine(Scene.model_validate(six_bar() | {"balance": {"about": "D"}})).available_fields["shaking_moment"]
    assert "about D at" in named.long_name


test_point_of_the_moment__is_on_the_frame = refusals(
    lambda about: Machine(Scene.model_validate(six_bar() | {"balance": {"about": about}})),
    ("K", r"'K' is not on the frame; known are: D, O, S, T"),
    ("Z", "'Z' is not a point"),
)


def test_sliding_input__shakes_about_its_guide():
    scene = sliding_input().model_dump(exclude_none=True)
    scene["guides"]["way"] |= {"x": 0.01, "y": 0.02}
    machine = Machine(Scene.model_validate(scene))
    assert "about way at" in machine.available_fields["shaking_moment"].long_name
    assert "shaking_force.order_1" not in machine.available_summaries
    fields = [*SHAKING, "frame.reaction_moment"]
    _, rows = moving(scene, fields, 16)
    fx, fy, moment, about_origin = (rows[field] for field in fields)
    size = np.abs(about_origin).max() + np.hypot(fx, fy).max()
    np.testing.assert_allclose(moment + 0.01 * fy - 0.02 * fx, about_origin, rtol=0, atol=256 * EPS * size)


# Orders


ORDERS = (1, 2, 4)


@pytest.mark.parametrize("revolutions", [1, 2])
@pytest.mark.parametrize("name", MACHINES)
def test_order__is_the_longer_half_axis_of_its_ellipse(name, revolutions):
    scene = changed(MACHINES[name], {"input.revolutions": revolutions})
    names, fields = [f"shaking_force.order_{n}" for n in ORDERS], SHAKING[:2]
    outcome = Machine(Scene.model_validate(scene), names).evaluate({})
    machine, rows = moving(scene, fields, POSITIONS * revolutions)
    force = rows[fields[0]] + 1j * rows[fields[1]]
    parts = np.fft.fft(force) / force.size
    for n, name in zip(ORDERS, names, strict=True):
        # What turns with the crank and against it, n times as fast; harmonics at POSITIONS − n are below rounding.
        exact = abs(parts[n * revolutions]) + abs(parts[-n * revolutions])
        found, figure = outcome.summaries[name][0], outcome.errors[name][0]
        assert abs(found - exact) <= figure + 64 * EPS * np.abs(force).max()
        assert figure <= 1e-9 * np.abs(force).max()
        turned = parts[n * revolutions] * np.exp(1j * n * machine.q)
        ellipse = turned + parts[-n * revolutions] * np.exp(-1j * n * machine.q)
        # Of 256 positions to a turn one lies within π n/256 rad of the half axis.
        assert found * math.cos(math.pi * n / POSITIONS) <= np.abs(ellipse).max() * (1 + 1e-9)


def piston_orders(ratio):
    """Sizes of the orders of the piston's −x″ over r, by the Fourier integrals of its place: n² c_n."""

    def place(phi):
        return mp.cos(phi) + mp.sqrt(1 - (ratio * mp.sin(phi)) ** 2) / ratio

    turn = [0, mp.pi / 2, mp.pi]
    return [abs(float(n**2 * 2 / mp.pi * mp.quad(lambda phi, n=n: place(phi) * mp.cos(n * phi), turn))) for n in ORDERS]


def test_rod_hardly_longer_than_the_crank__its_orders_are_off_by_no_more_than_the_error_figure():
    scene = slider_crank(0.3, 0.301, slider="piston", bodies={"piston_body": {"link": "piston", "mass": 2.0}})
    exact = 2.0 * 0.3 * SPEED**2 * np.array(piston_orders(mp.mpf(0.3) / mp.mpf(0.301)))
    names = [f"shaking_force.order_{n}" for n in ORDERS]
    outcome = Machine(Scene.model_validate(scene), names, accuracy=0.5).evaluate({})
    found, errors = (np.array([part[name][0] for name in names]) for part in (outcome.summaries, outcome.errors))
    assert (np.abs(found - exact) <= errors).all()
    # The figure isn't large because nothing is known.
    assert max(errors) < 0.5 * exact[0]
