"""Reduction to the input link against energy and power of the oracle's motion, and against laws of conservation.

The rows I(φ), dI/dφ, M(φ) of a press with every kind of body, shaft and action are compared with the kinetic energy
and the power of real forces on real velocities. Tolerances: see `machines.compare`.
"""

import math

import numpy as np
import pytest
from machines import compare, crank, evaluated, frame, rrp, variants_of
from oracle import EPS, Motion
from oracle_dynamics import moments, reduced_inertia, reduced_inertia_phi
from press import actions, bodies, forces, press

from engine import Machine, Scene, Verdict
from engine.compiling.threads import set_threads

I_FIELDS = ("reduced_inertia", "reduced_inertia_phi")


def test_reduced_inertia_and_its_slope__kinetic_energy():
    varied = {
        "groups.drive.mode": [1, -1, 1],
        "guides.way.angle": [0.25, 0.1, -0.2],
        "shafts.gear.ratio": [-2.0, 1.0, 3.0],
        "bodies.ram_body.mass": [12.0, 1e-3, 1e6],
        "bodies.coupler_body.shape.length": [1.0, 0.5, 2.0],
    }
    scene = press(bodies=bodies())
    machine, outcome = evaluated(scene, [*I_FIELDS], varied, positions=24)
    for i, variant in enumerate(variants_of(scene, varied)):
        found = {field: outcome.fields[field][i] for field in I_FIELDS}

        def rows(of: Scene) -> dict:
            return dict(
                zip(
                    I_FIELDS,
                    (reduced_inertia(Motion(of, machine.nodes)), reduced_inertia_phi(of, machine.nodes)),
                    strict=True,
                )
            )

        # Differences over 1/256 rad lose digits of I, which shows where long double is no longer than double.
        lost = 4 * 256 * float(np.finfo(np.longdouble).eps) * np.abs(found["reduced_inertia"]).max()
        compare(found, variant, rows, truncation={"reduced_inertia_phi": lost})


def test_reduced_moments__power_of_real_forces_on_real_velocities():
    scene = press(bodies=bodies(), **actions())
    names = [n for table in actions().values() for n in table] + ["gravity"]
    fields = [*(f"{n}.moment" for n in names), "reduced_moment", "input_moment"]
    varied = {"input.speed": [7.0, -3.0], "groups.drive.mode": [1, -1]}
    machine, outcome = evaluated(scene, fields, varied, positions=360)
    some = slice(5, None, 24)
    # The ends of the stroke come from cubics between positions: (h⁴/384) max|d⁗|, times the table's slope.
    ends = (2 * math.pi / 360) ** 4 / 384 * 20 * 2000
    truncation = {
        "from_low.moment": ends,
        "from_high.moment": ends,
        "reduced_moment": 2 * ends,
        "input_moment": 2 * ends,
    }
    for i, variant in enumerate(variants_of(scene, varied)):

        def rows(of: Scene) -> dict:
            each = moments(Motion(of, machine.nodes[some]))
            total = sum(each.values())
            inertia = 0.5 * of.input.speed**2 * reduced_inertia_phi(of, machine.nodes[some])
            return {f"{n}.moment": m for n, m in each.items()} | {
                "reduced_moment": total,
                "input_moment": inertia - total,
            }

        compare({f: outcome.fields[f][i, some] for f in fields}, variant, rows, truncation=truncation)


def test_conservative_forces__no_work_over_a_cycle():
    scene = press(
        bodies=bodies(),
        forces={"press_force": {"type": "constant", "on": "R", "angle": 0.25, "force": 500.0}},
        moments={"twist": actions()["moments"]["twist"]},
        springs={"coil": {"between": ["R", "K"], "stiffness": 400.0, "free_length": 0.8}},
    )
    names = ("gravity", "press_force", "twist", "coil")
    _, outcome = evaluated(scene, [f"{n}.moment" for n in names], {}, positions=360)
    for row in outcome.fields.values():
        # The mean of a smooth periodic row at equal distances is exact long before 360 positions: rounding is left,
        # of the row itself and of its potential's terms, some 100 roundings of its peak.
        assert abs(row.mean()) <= 100 * EPS * np.abs(row).max()
        assert np.abs(row).max() > 1.0


def test_shafts_of_constant_ratio__constant_inertia_and_moment():
    scene = {
        "points": {"O": frame(0.0, 0.0), "S": frame(1.0, 0.0)},
        "input": crank(),
        "shafts": {
            "fast": {"geared_to": "crank", "ratio": 8.0, "inertia": 0.02},
            "back": {"geared_to": "crank", "ratio": -3.0, "inertia": 0.5, "pivot": "S"},
        },
        "bodies": {"wheel": {"link": "back", "mass": 2.0, "x": 0.25, "inertia": 0.125}},
        "moments": {"load": {"type": "constant", "on": "back", "moment": 7.0}},
    }
    machine = Machine(
        Scene.model_validate(scene),
        fields=[*I_FIELDS, "reduced_moment", "input_moment"],
        summaries=["first_kind_inertia", "reduced_inertia.range"],
        positions=16,
    )
    outcome = machine.evaluate({})
    # 0.02·8² + (0.5 + 0.125 + 2·0.25²)·3²
    assert outcome.summaries["first_kind_inertia"][0] == pytest.approx(8.03, rel=4 * EPS)
    assert outcome.summaries["reduced_inertia.range"][0] == 0.0
    np.testing.assert_allclose(outcome.fields["reduced_inertia"], 8.03, rtol=4 * EPS)
    assert (outcome.fields["reduced_inertia_phi"] == 0.0).all()
    assert (outcome.fields["reduced_moment"] == -21.0).all()
    assert (outcome.fields["input_moment"] == 21.0).all()


def test_sliding_input__reduced_mass_and_force():
    scene = {
        "gravity": 9.81,
        "guides": {"way": {"angle": 0.3}, "cross": {"x": 0.05, "y": 0.1, "angle": 1.8}},
        "input": {
            "type": "slider",
            "link": "ram",
            "guide": "way",
            "point": "A",
            "start": 0.1,
            "stop": 0.5,
            "speed": 0.3,
        },
        "groups": {"trammel": rrp("B", ("beam", "A", 1.0), "second", "cross")},
        "bodies": {
            "ram_body": {"link": "ram", "mass": 5.0},
            "beam_body": {"link": "beam", "mass": 2.0, "x": 0.4, "y": 0.1, "inertia": 0.3},
            "second_body": {"link": "second", "mass": 3.0, "x": 0.2},
        },
        "forces": {"rub": {"type": "against_motion", "on": "B", "force": 30.0}},
    }
    fields = [*I_FIELDS, "gravity.moment", "rub.moment"]
    machine, outcome = evaluated(scene, fields, {}, positions=16)
    q = 0.1 + 0.4 * machine.nodes

    def rows(of: Scene) -> dict:
        motion = Motion(of, q)
        forces = {f"{name}.moment": row for name, row in moments(motion).items()}
        return forces | dict(zip(I_FIELDS, (reduced_inertia(motion), reduced_inertia_phi(of, q)), strict=True))

    compare({f: outcome.fields[f][0] for f in fields}, scene, rows)


# The same numbers another way

# Loads of each sort that may vary, few enough for a compiler.
LOADED = {"bodies": bodies(), **actions()}
LOADED["forces"] = {name: LOADED["forces"][name] for name in ("cut",)}
LOADED["moments"] = {name: LOADED["moments"][name] for name in ("brake",)}
SUMMARIES = ("required_drive_moment", "excess_work", "ram.stroke")
ROWS = ("input_moment", "work")


@pytest.fixture(scope="module")
def varied() -> dict[str, np.ndarray]:
    """Two shapes, each with thirty sets of masses and forces."""
    rng = np.random.default_rng(2)
    varied = {
        "input.length": np.repeat([0.3, 0.25], 30),
        "bodies.ram_body.mass": rng.uniform(1, 20, 60),
        "bodies.crank_body.inertia": rng.uniform(0, 1, 60),
        "forces.cut.force": rng.uniform(-1000, 1000, 60),
        "moments.brake.moment": rng.uniform(0, 10, 60),
        "springs.coil.stiffness": rng.uniform(0, 500, 60),
        "gravity": rng.uniform(0, 10, 60),
    }
    order = rng.permutation(60)
    return {path: values[order] for path, values in varied.items()}


@pytest.fixture(scope="module")
def machine(varied) -> Machine:
    return Machine(Scene.model_validate(press(**LOADED)), SUMMARIES, ROWS, varied, positions=48)


def results(machine: Machine, varied: dict) -> dict[str, np.ndarray]:
    outcome = machine.evaluate(varied)
    assert (outcome.status == Verdict.OK).all()
    errors = {f"error of {name}": row for name, row in outcome.errors.items()}
    return {name: row.copy() for name, row in (outcome.summaries | errors | outcome.fields).items()}


def part_of(varied: dict, cut: slice) -> dict:
    return {path: values[cut] for path, values in varied.items()}


def test_order_of_variants__same_bits(machine, varied):
    together = results(machine, varied)
    backwards = results(machine, part_of(varied, slice(None, None, -1)))
    for name, row in backwards.items():
        np.testing.assert_array_equal(row[::-1], together[name], err_msg=name)


def test_number_of_threads__same_bits(machine, varied):
    shapes = varied | {"input.length": np.linspace(0.2, 0.3, 60)}
    found = []
    try:
        for count in (1, 2, 3):
            set_threads(count)
            found.append((results(machine, varied), results(machine, shapes)))
    finally:
        set_threads(0)
    for one, *others in zip(*found, strict=True):
        for other in others:
            for name, row in one.items():
                np.testing.assert_array_equal(row, other[name], err_msg=name)


def test_evaluation_split_into_calls__same_bits(machine, varied):
    shapes = varied | {"input.length": np.linspace(0.2, 0.3, 60)}
    together = results(machine, shapes)
    for cut in (slice(0, 1), slice(1, 24), slice(24, 60)):
        for name, row in results(machine, part_of(shapes, cut)).items():
            np.testing.assert_array_equal(row, together[name][cut], err_msg=name)


# Scaling


def scaled(part: object, lengths: float, masses: float) -> object:
    """Scene with its lengths, masses and moments of inertia scaled."""
    factors = {"x": lengths, "y": lengths, "length": lengths, "offset": lengths, "mass": masses}
    factors["inertia"] = masses * lengths**2
    if not isinstance(part, dict):
        return part
    return {
        k: v * factors[k] if k in factors and isinstance(v, float) else scaled(v, lengths, masses)
        for k, v in part.items()
    }


def shapeless() -> dict:
    return {name: body for name, body in bodies().items() if "shape" not in body}


@pytest.mark.parametrize(("lengths", "masses"), [(2.0**7, 1.0), (2.0**-20, 2.0**30), (2.0**20, 2.0**-40)])
def test_lengths_and_masses_scaled_by_powers_of_two__same_bits(lengths, masses):
    # Powers of two change exponents alone: every rounding is the same.
    scene = press(
        bodies=shapeless(),
        moments={"load": {"type": "constant", "on": "rocker", "moment": 5.0}},
    )
    fields = ["ram.slide", "rocker.angle_phiphi", *I_FIELDS, "gravity.moment", "load.moment"]
    _, small = evaluated(scene, fields, {}, positions=24)
    _, large = evaluated(scaled(scene, lengths, masses), fields, {}, positions=24)
    factors = (lengths, 1.0, masses * lengths**2, masses * lengths**2, masses * lengths, 1.0)
    for field, factor in zip(fields, factors, strict=True):
        np.testing.assert_array_equal(large.fields[field], factor * small.fields[field], err_msg=field)


def test_speed_scaled__resistances_by_their_power():
    scene = press(
        bodies=shapeless(),
        forces={name: forces()[name] for name in ("cut", "rub", "oil", "air")},
    )
    fields = ["cut.moment", "rub.moment", "oil.moment", "air.moment", "input_moment", "reduced_moment"]
    _, outcome = evaluated(scene, fields, {"input.speed": [5.0, 20.0]}, positions=24)
    for name, factor in (("cut", 1.0), ("rub", 1.0), ("oil", 4.0), ("air", 16.0)):
        slow, fast = outcome.fields[f"{name}.moment"]
        np.testing.assert_array_equal(fast, factor * slow)
    slow, fast = outcome.fields["input_moment"] + outcome.fields["reduced_moment"]
    np.testing.assert_allclose(fast, 16 * slow, rtol=0, atol=64 * EPS * np.abs(fast).max())


def test_float32__close_to_float64():
    scene = press(bodies=bodies(), forces={name: forces()[name] for name in ("cut", "rub", "oil", "air")})
    fields = ["ram.slide", "ram.slide_phi", "rocker.angle_phiphi", *I_FIELDS, "cut.moment", "air.moment"]
    _, outcome = evaluated(scene, fields, {}, positions=24, dtype=np.float32)
    exact, wide = evaluated(scene, fields, {}, positions=24)
    assert all(row.dtype == np.float32 for row in outcome.fields.values())

    def rows(of: Scene) -> dict:
        motion = Motion(of, exact.nodes)
        forces = {f"{n}.moment": row for n, row in moments(motion).items()}
        inertia = dict(zip(I_FIELDS, (reduced_inertia(motion), reduced_inertia_phi(of, exact.nodes)), strict=True))
        return forces | inertia | {field: motion.field(field) for field in fields[:3]}

    # Same bound as for float64, with float32's rounding.
    compare({f: outcome.fields[f][0] for f in fields}, scene, rows, rounding=float(np.finfo(np.float32).eps))
    compare({f: wide.fields[f][0] for f in fields}, scene, rows)
