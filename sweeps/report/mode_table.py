"""The assembly modes of groups of free links in words."""

from engine import AssemblyMode, Scene
from sweeps.text.engineer_units import quantity_text
from sweeps.text.tables import table


def mode_table(scene: Scene, modes: dict[str, tuple[AssemblyMode, ...] | None]) -> str:
    """All real modes at the first position: where points lie, the transmission, which one the scene means.

    Parameters
    ----------
    scene : Scene
    modes : dict of str to tuple of AssemblyMode
        Of each group of free links; None for one that depends on a group whose mode isn't given.
    """
    if not modes:
        return "no group of free links ([links]) that needs an assembly mode: dyads have mode = 1 and mode = -1"
    parts = []
    for group, found in modes.items():
        if found is None:
            parts.append(
                f"{group}: depends on a group whose mode the scene doesn't give; give that one to list its own"
            )
            continue
        count = f"{len(found)} real assembly mode{'' if len(found) == 1 else 's'}"
        parts.append(f"{group}: {count if found else 'no assembly'} at the first position")
        if not found:
            continue
        points = list(found[0].points)
        rows = [["mode", *(f"{name} (x, y)" for name in points), "transmission", ""]]
        for number, mode in enumerate(found, 1):
            places = [", ".join(quantity_text(value, "m") for value in mode.points[name]) for name in points]
            rows.append([str(number), *places, f"{mode.transmission:.3f}", "the scene's" if mode.chosen else ""])
        parts.append(table(rows, "  "))
        if not any(mode.chosen for mode in found) and not points:
            parts.append(
                "  the scene gives none of them: set near, by a point of one of the group's links, away from joints"
            )
        elif not any(mode.chosen for mode in found):
            parts.append(f'  the scene gives none of them: set near.{points[0]} = {{ x = "…", y = "…" }}')
    return "\n".join(parts)
