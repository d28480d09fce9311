"""The register of quantities: every field (a row over positions) and summary (a number per variant) one may ask."""

from collections.abc import Iterable

from engine.quantities.quantity import STATISTICS, InputUnits, Quantity, has_cycle
from engine.scene.parts import FRAME, CrankInput
from engine.scene.scene import Scene
from engine.scene.structure import Structure


def _derived(unit: str, order: int, q: str) -> str:
    return f"{unit} {q}-{order}"


def kinematic_fields(scene: Scene, structure: Structure) -> list[Quantity]:
    """Positions and transfer functions of all points, links, sliders and groups."""
    q = InputUnits.of(scene).q
    found = []
    points = [n for n, p in scene.points.items() if p.link != FRAME]
    points += [g.inner for g in scene.groups.values() if hasattr(g, "inner")]
    points.append(scene.input.pin if isinstance(scene.input, CrankInput) else scene.input.point)
    words = ("", "first derivative by the input of the ", "second derivative by the input of the ")
    for name in points:
        for axis in ("x", "y"):
            for order, suffix in enumerate(("", "_phi", "_phiphi")):
                unit = _derived("m", order, q) if order else "m"
                found.append(
                    Quantity(f"{name}.{axis}{suffix}", f"{words[order]}{axis} coordinate of point {name}", unit)
                )
    for name in structure.links:
        for order, suffix in enumerate(("", "_phi", "_phiphi")):
            unit = _derived("rad", order, q) if order else "rad"
            found.append(Quantity(f"{name}.angle{suffix}", f"{words[order]}angle of link {name}", unit))
    for name in structure.sliders:
        for order, suffix in enumerate(("", "_phi", "_phiphi")):
            unit = _derived("m", order, q) if order else "m"
            found.append(Quantity(f"{name}.slide{suffix}", f"{words[order]}displacement of slider {name}", unit))
    for name in scene.groups:
        found.append(Quantity(f"{name}.transmission", f"sine of the transmission angle of group {name}", "1"))
    return [*found, *time_fields(found)]


RATE_NAMES = {
    "x": ("vx", "ax"),
    "y": ("vy", "ay"),
    "angle": ("angular_velocity", "angular_acceleration"),
    "slide": ("velocity", "acceleration"),
}


def rates_in_time(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Names of the first and second derivative by time of every kinematic field that has transfer functions."""
    stems = [name.removesuffix("_phi") for name in names if name.endswith("_phi")]
    found = {}
    for stem in stems:
        owner, _, kind = stem.rpartition(".")
        first, second = RATE_NAMES[kind]
        found[stem] = (f"{owner}.{first}", f"{owner}.{second}")
    return found


def time_fields(fields: list[Quantity]) -> list[Quantity]:
    """Velocities and accelerations at the input's uniform speed."""
    by_name = {q.name: q for q in fields}
    found = []
    for stem, (first, second) in rates_in_time(by_name).items():
        of, unit = by_name[stem].long_name, "rad" if stem.endswith(".angle") else "m"
        found.append(Quantity(first, f"velocity of the {of}", f"{unit} s-1"))
        found.append(Quantity(second, f"acceleration of the {of} at uniform speed of the input", f"{unit} s-2"))
    return found


def dynamic_fields(scene: Scene, actions: tuple[str, ...]) -> list[Quantity]:
    """Reduced inertia and moments, work and speed."""
    u = InputUnits.of(scene)
    apart = ", without friction in pairs" if scene.friction else ""
    found = [
        Quantity("reduced_inertia", "reduced moment of inertia", u.inertia),
        Quantity(
            "reduced_inertia_phi",
            "derivative of the reduced moment of inertia by the input",
            f"{u.inertia} {u.per_q}",
        ),
        Quantity("reduced_moment", f"reduced moment of all actions but the driver{apart}", u.moment),
        Quantity("input_moment", f"input moment that keeps the speed uniform{apart}", u.moment),
        *(Quantity(f"{name}.moment", f"reduced moment of {name}", u.moment) for name in actions),
    ]
    if has_cycle(scene):
        found += [
            Quantity("work", "work of all moments with the constant driver: change of kinetic energy", "J"),
            Quantity("speed", "angular speed of the input link with the flywheel, by magnitude", "rad s-1"),
        ]
    return found


def statistics_of(field: Quantity, q: str) -> list[Quantity]:
    """Summaries that are statistics of a field."""
    return [
        Quantity(
            f"{field.name}.{suffix}",
            f"{words} the {field.long_name}",
            q if suffix.endswith("_at") else field.units,
        )
        for suffix, words in STATISTICS.items()
    ]


def machine_summaries(scene: Scene, structure: Structure, turning: tuple[str, ...]) -> list[Quantity]:
    """Summaries that are not statistics of one field; `turning` names the links that may swing."""
    q = InputUnits.of(scene).q
    found = [
        Quantity(f"{g}.transmission_angle", f"least transmission angle of group {g} over the cycle", "rad")
        for g in scene.groups
    ]
    for kind, names, unit, word in (
        ("stroke", structure.sliders, "m", "slider"),
        ("swing", turning, "rad", "link"),
    ):
        for name in names:
            found.append(Quantity(f"{name}.{kind}", f"{kind} of {word} {name}", unit))
            found.append(Quantity(f"{name}.{kind}_low", f"low end of the {kind} of {word} {name}", unit))
            found.append(Quantity(f"{name}.{kind}_high", f"high end of the {kind} of {word} {name}", unit))
            found.append(Quantity(f"{name}.{kind}_low_at", f"input position at the low end of the {kind} of {name}", q))
            found.append(
                Quantity(f"{name}.{kind}_high_at", f"input position at the high end of the {kind} of {name}", q)
            )
            if has_cycle(scene):
                found.append(Quantity(f"{name}.{kind}_time_ratio", f"quick-return ratio of the {kind} of {name}", "1"))
    found.append(
        Quantity(
            "first_kind_inertia",
            "constant part of the reduced moment of inertia",
            InputUnits.of(scene).inertia,
        )
    )
    if any(m.type in ("dc_motor", "induction_motor") for m in scene.moments.values()):
        found.append(Quantity("motor_moment", "moment of the motors at the input's speed, reduced to the input", "N m"))
    if has_cycle(scene):
        found += _cycle_summaries(scene)
    return found


def _cycle_summaries(scene: Scene) -> list[Quantity]:
    found = [
        Quantity(
            "mean_useful_moment",
            "mean moment of the useful resistances over the cycle, reduced to the input",
            "N m",
        ),
        Quantity("required_drive_moment", "constant driving moment that closes the cycle", "N m"),
        Quantity("required_power", "mean power of the required driving moment", "W"),
        Quantity("excess_work", "excess work", "J"),
        Quantity(
            "power_balance_residual",
            "power of the inertia forces against the numerical derivative of kinetic energy, worst relative difference",
            "1",
        ),
    ]
    flywheel = scene.flywheel
    if flywheel is None:
        return found
    if flywheel.speed_fluctuation is not None:
        found += [
            Quantity("flywheel_excess_work", "flywheel inertia by the excess work", "kg m2"),
            Quantity("flywheel_merzalov", "flywheel inertia by Merzalov's method", "kg m2"),
            Quantity("flywheel_wittenbauer", "flywheel inertia by Wittenbauer's method, exact", "kg m2"),
            Quantity(
                "excess_work_difference",
                "flywheel by excess work, relative difference from the exact one",
                "1",
            ),
            Quantity("merzalov_difference", "flywheel by Merzalov, relative difference from the exact one", "1"),
        ]
    if flywheel.inertia is not None or flywheel.speed_fluctuation is not None:
        found += [
            Quantity("flywheel_used", "flywheel inertia on the input link: as given, or as Wittenbauer asks", "kg m2"),
            Quantity("speed_fluctuation", "coefficient of speed fluctuation with the flywheel", "1"),
            Quantity("speed_min", "least angular speed of the input link with the flywheel, by magnitude", "rad s-1"),
            Quantity(
                "speed_max", "greatest angular speed of the input link with the flywheel, by magnitude", "rad s-1"
            ),
        ]
    return found
