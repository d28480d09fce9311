"""Default summaries of machines and their regimes."""

import engine
from sweeps.study.study_content import ReadyMachine


def answers(machine: ReadyMachine) -> tuple[str, ...]:
    """Numbers that an engineer wants of a machine and its regimes, in the order in which they are read."""
    scene, known = machine.scene, machine.available_summaries
    of_machine = machine.register.answers if isinstance(machine, engine.Machine) else ()
    of_elements = (
        n for n, q in known.items() if n.partition(".")[0] in scene.elements and q.rank == engine.Rank.ANSWER
    )
    of_regimes = (name for name in informative_summaries(machine) if known[name].rank != engine.Rank.CHECK)
    return (*of_machine, *of_elements, *of_regimes)


def default_summaries(machine: ReadyMachine) -> tuple[str, ...]:
    """Default summaries: the answers, and further ones of cycle, flywheel, elements and regimes."""
    left_out = {"first_kind_inertia", "power_balance_residual", "conservative_work_residual", "loop_closure_residual"}
    left_out |= set(engine.ACCURACY_SUMMARIES)
    scene, known = machine.scene, machine.available_summaries
    further = (n for n in known if n not in left_out and not engine.is_warning(n))
    further = (n for n in further if "." not in n or n.partition(".")[0] in scene.elements)
    return tuple(dict.fromkeys((*answers(machine), *further, *informative_summaries(machine))))


def informative_summaries(machine: ReadyMachine) -> tuple[str, ...]:
    """Informative summaries of all regimes: work of active loads only, no prescribed speed."""
    scene = machine.scene
    if not scene.regimes:
        return ()
    loads, found = machine.mechanics.loads, []
    for name, regime in scene.regimes.items():
        keys = ["mean_speed", *_SPEEDS, "speed_fluctuation"]
        if isinstance(regime, engine.RunRegime):
            keys = _run_keys(scene, regime)
        motors = [motor for motor in loads.motors if motor not in regime.off]
        roles = {term.role for term in loads.terms if term.action not in regime.off}
        keys += _work_keys(bool(motors), roles)
        if len(motors) == 1:
            keys += [f"{motors[0]}_shaft_torque_peak", f"{motors[0]}_shaft_torque_rms"]
        if not isinstance(regime, engine.RunRegime):
            keys += [f"{m}_slip" for m in motors if scene.moments[m].type == "induction_motor"]
            keys.append("multiplier")
            keys += ["flywheel"] if name in engine.sized_regimes(scene) else []
        found += [f"{name}.{key}" for key in (*keys, *_coupling_keys(scene, regime))]
    return tuple(found)


def _coupling_keys(scene: engine.Scene, regime: engine.Regime) -> list[str]:
    """Summaries of a closed coupling."""
    found: list[str] = []
    for name, coupling in scene.couplings.items():
        if not isinstance(regime, engine.RunRegime) and coupling.type == "friction_clutch":
            found.append(f"{name}_moment_peak")
        elif name not in regime.off:
            clutch = ("slip_time", "lock_up_time", "lock_up_speed") if coupling.type == "friction_clutch" else ("slip",)
            found += [f"{name}_{key}" for key in ("heat", "moment_peak", *clutch)]
    return found


def main_slider(scene: engine.Scene) -> str | None:
    """The main slider: a cylinder's piston, else the last one on a guide of the frame."""
    for cylinder in scene.cylinders.values():
        return cylinder.piston
    parts = (part for group in scene.groups.values() for part in (group.first, group.second))
    on_frame = {p.link for p in parts if hasattr(p, "guide") and scene.guides[p.guide].link == engine.FRAME}
    return next((name for name in reversed(engine.sliders_of(scene)) if name in on_frame), None)


_SPEEDS = ("speed_min", "speed_max")


def _run_keys(scene: engine.Scene, regime: engine.RunRegime) -> list[str]:
    given = regime.rest or getattr(regime, engine.run_keys(scene.input).speed) is not None
    keys = ["time", "angle" if isinstance(scene.input, engine.CrankInput) else "displacement"]
    keys += [] if given else ["final_speed", *_SPEEDS]
    if regime.rest or not scene.has_cycle:
        slider = main_slider(scene)
        keys += ["final_position", *([f"{slider}.final_position"] if slider and not scene.inputs else [])]
    return keys if scene.has_cycle else [*keys, "end_reached", "impact_energy"]


def _work_keys(has_motors: bool, roles: set[str]) -> list[str]:
    """Work of active loads."""
    keys = ["motor_moment_peak", "motor_moment_rms", "motor_power", "motor_work"] if has_motors else []
    channels = {"driving": "driving_work", "useful": "useful_work", "harmful": "harmful_work", "braking": "brake_heat"}
    keys += [key for role, key in channels.items() if role in roles]
    return [*keys, "efficiency"] if "useful" in roles and (has_motors or "driving" in roles) else keys
