"""Table of the assembly modes of groups of free links."""

from engine import AssemblyMode, counted, quantity_text
from sweeps.text.tables import table


def mode_table(modes: dict[str, tuple[AssemblyMode, ...] | None]) -> str:
    """All real modes at the first position: point positions, transmission, and the scene's choice.

    Parameters
    ----------
    modes : dict of str to tuple of AssemblyMode
        By group of free links; None for one that depends on a group whose mode isn't given.
    """
    if not modes:
        return "no free links ([links]) that need an assembly mode; dyads use mode = 1 or mode = -1"
    parts = []
    for group, found in modes.items():
        if found is None:
            parts.append(f"{group}: depends on a group without a mode; set that mode first")
            continue
        count = counted(len(found), "real assembly mode")
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
                "  the scene selects none: set near, with a point of one of the group's links, away from joints"
            )
        elif not any(mode.chosen for mode in found):
            parts.append(f'  the scene selects none: set near.{points[0]} = {{ x = "…", y = "…" }}')
    return "\n".join(parts)
