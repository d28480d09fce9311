"""Balance shafts of engines: speeds, unbalances and angles, and the unbalance without them."""

import numpy as np

import engine
from sweeps.report.sizing.trial_runs import degrees_text
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.tables import table

# Balanced orders: shafts that turn faster than twice the crank speed are not built.
ORDERS = (1, 2)
WORDS = {1: "primary", 2: "secondary"}


def engines_of(scene: engine.Scene) -> dict[str, engine.EngineElement]:
    """The engines among the elements of a scene, by name."""
    return {name: e for name, e in scene.elements.items() if isinstance(e, engine.EngineElement)}


def balance_shaft_text(scene: engine.Scene, planes: str | None = None) -> str:
    """Report on balance shafts for every engine of a scene.

    Parameters
    ----------
    scene : Scene
    planes : str, optional
        Two positions along the crank from its middle, such as "-80 mm, 80 mm"; default: the outermost throws.

    Raises
    ------
    InputError
        Invalid positions.
    """
    given = None if planes is None else numbers_in_row("--planes", planes, ("length", "length"))
    return "\n\n".join(_engine_text(name, element, given) for name, element in engines_of(scene).items())


def _engine_text(name: str, element: engine.EngineElement, given: tuple[float, float] | None) -> str:
    numbers = element.own_numbers()
    made = engine.made_engine(element, numbers)
    weights = engine.crankshaft_counterweights(made, numbers["balanced_rotating"], numbers["balanced_reciprocating"])
    found = engine.remaining_shaking(engine.engine_shaking(made, ORDERS), [weights])
    # Couples need the spacing of the throws.
    places = made.layout.positions if element.spacing is not None else np.zeros(1)
    planes = given or (float(places.min()), float(places.max()))
    shafts = engine.balance_shafts(found, planes)
    lines = [f"{name} at {engine.quantity_text(element.speed, 'rad s-1')}, with its counterweights on the crank:"]
    lines.append(table(_shaking_rows(found, element), "  "))
    if not shafts:
        return "\n".join(
            [*lines, "No balance shafts needed: the primary and secondary forces and couples are balanced."]
        )
    used = planes if planes[0] != planes[1] else planes[:1]
    rows = [("shaft", "speed", "turns", *(f"at {engine.quantity_text(plane, 'm')}" for plane in used))]
    for shaft in shafts:
        crank = (shaft.order, shaft.sense) == (1, 1)
        words = "the crank itself" if crank else f"balance shaft, {WORDS[shaft.order]}"
        turns = "with the crank" if shaft.sense > 0 else "against it"
        unbalances = (
            f"{engine.quantity_text(abs(u), 'kg m')} at {degrees_text(u)}" for u in shaft.unbalances.reshape(-1)
        )
        rows.append((words, f"{shaft.order} × crank", turns, *unbalances))
    kinds = "force and couple" if len(used) > 1 else "force"
    lines.append(f"Unbalances that cancel the primary and secondary {kinds}:")
    lines.append(table(rows, "  "))
    throw = degrees_text(np.exp(1j * made.layout.throws.reshape(-1)[0]))
    lines.append(
        f"Angles from the engine's axis in the direction of rotation, with the throw of cylinder 1 at {throw}."
    )
    if element.spacing is None:
        lines.append("Couples omitted: they need the cylinder spacing.")
    return "\n".join(lines)


def _shaking_rows(found: engine.EngineShaking, element: engine.EngineElement) -> list[tuple[str, ...]]:
    square = element.speed**2
    rows = [("maximum", *(WORDS[order] for order in ORDERS))]
    kinds = [("force", found.forces, found.force_terms, "N")]
    if element.spacing is not None:
        kinds.append(("couple", found.couples, found.couple_terms, "N m"))
    for kind, vector, terms, unit in kinds:
        sizes = np.where(vector.major > 1e-12 * terms, vector.major, 0.0).reshape(-1) * square
        rows.append((kind, *(engine.quantity_text(float(size), unit) for size in sizes)))
    return rows
