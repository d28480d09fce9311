"""Many loads of one kind: they are data of one law, so that no printed function grows with their number."""

import numpy as np
import pytest
from closed_forms import slider_motion
from machines import frame, slider_crank

from engine import Machine, Scene

CRANK, ROD = 0.05, 0.2
POST = np.array([0.4, 0.1])


def scene_of(**loads):
    points = {"O": frame(0.0, 0.0), "F": frame(*POST)}
    bodies = {"mass": {"link": "ram", "mass": 2}}
    return Scene.model_validate(slider_crank(CRANK, ROD, 6.0, **{"points": points, "bodies": bodies} | loads))


def over_angle(i):
    return {
        "type": "table",
        "on": "crank",
        "over_angle": [0.0, 1.0 + 0.01 * i, 3.0, 4.0 + 0.02 * i],
        "moment": [5.0, 1.0 + i, -2.0, 3.0 * i],
        "interpolation": "linear",
    }


def over_stroke(i):
    return {
        "type": "table",
        "on": "B",
        "angle": np.pi,
        "slider": "ram",
        "measured_from": "low end",
        "over_stroke": [0.0, 0.02 + 1e-3 * i, 0.1],
        "force": [10.0, 20.0 + i, 5.0],
        "interpolation": "linear",
    }


def spring(i):
    return {"between": ["B", "F"], "stiffness": 100.0 + i, "free_length": 0.2 + 1e-3 * i, "damping": 1.0 + i}


def other(group, type_, **keys):
    number = {key: value for key, value in keys.items() if key != "on"}
    return group, lambda i: {"type": type_, "on": keys["on"], **{k: v * (i + 1) for k, v in number.items()}}


KINDS = {
    "tables over the angle": ("moments", over_angle),
    "tables over a stroke": ("forces", over_stroke),
    "springs": ("springs", spring),
    "torsion springs": other("moments", "torsion_spring", on="rod", stiffness=1.0, free_angle=0.01),
    "constant forces": other("forces", "constant", on="B", angle=0.1, force=1.0),
    "constant moments": other("moments", "constant", on="rod", moment=1.0),
    "forces against motion": other("forces", "against_motion", on="B", force=1.0),
    "linear drags": other("forces", "linear_drag", on="B", coefficient=1.0),
    "quadratic drags": other("forces", "quadratic_drag", on="B", coefficient=1.0),
}


@pytest.mark.parametrize("kind", KINDS)
def test_printed_functions__have_as_many_lines_for_few_loads_as_for_many(kind):
    group, make = KINDS[kind]
    asked = ["required_power", "input.reaction.peak", "frame.reaction_moment.peak"]

    def lines(count):
        machine = Machine(scene_of(**{group: {f"load_{i}": make(i) for i in range(count)}}), asked)
        return len(machine.source().splitlines())

    assert lines(10) == lines(40)


def test_many_loads__add_up_to_the_sum_of_each(subtests):
    """Tables by `np.interp`, the slider's place in closed form; a variant may scale or take away any of them."""
    moments = {f"m{i}": over_angle(i) for i in range(4)}
    forces = {f"f{i}": over_stroke(i) for i in range(3)}
    springs = {f"s{i}": spring(i) | {"damping": 0} for i in range(3)}
    varied = {"moments.m1.scale": [1.0, -2.0, 0.0], "forces.f2.scale": [1.0, 3.0, 0.0]}
    varied |= {f"springs.s{i}.stiffness": [100.0 + i, 50.0 * i, 0.0] for i in range(3)}
    varied = {path: np.array(values) for path, values in varied.items()}
    scene = scene_of(moments=moments, forces=forces, springs=springs, bodies={})
    machine = Machine(scene, ["required_power", "input_moment.mean"], ["input_moment"], list(varied), positions=360)
    found = machine.evaluate(varied)

    q = machine.nodes
    x, rate, _ = slider_motion(q, CRANK, ROD, by=np)
    length = np.hypot(x - POST[0], POST[1])
    for k in range(3):
        scale = {path: values[k] for path, values in varied.items()}
        moment, mean = np.zeros_like(q), 0.0
        for name, load in moments.items():
            angles, values = np.append(load["over_angle"], 2 * np.pi), np.append(load["moment"], load["moment"][0])
            weight = scale.get(f"moments.{name}.scale", 1.0)
            moment += weight * np.interp(q, angles, values)
            mean += weight * np.trapezoid(values, angles) / (2.0 * np.pi)
        for name, load in forces.items():
            force = np.interp(x - (ROD - CRANK), load["over_stroke"], load["force"])
            moment -= scale.get(f"forces.{name}.scale", 1.0) * force * rate
        for name, load in springs.items():
            pull = scale[f"springs.{name}.stiffness"] * (load["free_length"] - length)
            moment += pull * (x - POST[0]) / length * rate
        with subtests.test(variant=k):
            # Sums of ten curves of about their greatest value: a few roundings of each.
            allowed = 100.0 * np.finfo(float).eps * np.abs(moment).max()
            assert np.abs(found.fields["input_moment"][k] + moment).max() <= allowed
            # Forces over a place and springs do no work over a cycle.
            assert abs(found.summaries["input_moment.mean"][k] + mean) <= found.errors["input_moment.mean"][k]
            assert found.summaries["required_power"][k] == pytest.approx(-6.0 * mean, rel=1e-12)
