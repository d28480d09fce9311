"""The laws of second inputs relative to the first: rate, turns per cycle, and the numbers they fix."""

import math

from engine.scene.scene import Scene, scene_numbers


def law_rate(scene: Scene, name: str) -> float:
    """Rate of the argument of a second input's law with respect to the first input [rad per rad, or per m]."""
    second = scene.inputs[name]
    if second.period is not None:
        return math.tau / (scene.input.speed * second.period)
    return 1.0 if second.travel is None else math.tau / second.travel


def drive_turns(scene: Scene, name: str) -> float:
    """Net turns of a second input relative to its base per turn (or 2π m) of the first input; 0 for a slider."""
    second = scene.inputs[name]
    if second.type == "slider":
        return 0.0
    by_law = (second.ratio + second.advance / math.tau) * law_rate(scene, name)
    return by_law + second.speed / scene.input.speed


def fixed_by_laws(scene: Scene) -> set[str]:
    """Numbers that can't be varied because of second inputs.

    The cycle must close in every variant, and section boundaries are laid out once for all variants.
    """
    cycle = scene.has_cycle
    found: set[str] = set()
    for name, second in scene.inputs.items():
        at, speed = f"inputs.{name}", getattr(second, "speed", 0.0)
        placed = second.sections or second.table is not None
        if cycle:
            found |= {f"{at}.ratio", f"{at}.speed"}
        if cycle or placed:
            found |= {f"{at}.period", f"{at}.travel"}
            found |= {"input.speed"} if second.period is not None else set()
        found |= {"input.speed"} if cycle and speed != 0.0 else set()
        if second.advance:
            found |= {p for p in scene_numbers(scene) if p.startswith(f"{at}.sections.") and not p.endswith(".angle")}
    return found
