"""Remarks on valid but suspicious scenes."""

from engine import Scene, scene_numbers

# Highest dry friction coefficient of technical materials.
MOST_FRICTION = 1.5
# Tables with friction coefficients, and their key.
_RUBBING = (("friction", "coefficient"), ("moments", "friction"), ("elements", "friction"))


def remarks_on(scene: Scene) -> list[str]:
    """Remarks on a scene."""
    found, numbers = [], scene_numbers(scene)
    for table, key in _RUBBING:
        for name, part in getattr(scene, table).items():
            path = f"{table}.{name}.{key}"
            # The friction of some elements is a force.
            value = getattr(part, key, None) if path in numbers and numbers[path].dimension == "number" else None
            if isinstance(value, float) and value > MOST_FRICTION:
                found.append(
                    f"{path} = {value:g}: coefficients of friction rarely exceed {MOST_FRICTION:g}; is it a percentage?"
                )
    for name, cylinder in scene.cylinders.items():
        if cylinder.type == "pump" and cylinder.suction > cylinder.discharge:
            found.append(
                f"cylinders.{name}: suction exceeds discharge, so the liquid drives the machine; is this intended?"
            )
    return found
