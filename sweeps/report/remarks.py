"""What is allowed in a scene but hardly meant."""

from engine import Scene, scene_numbers

# Above this no dry pair of technical materials comes.
MOST_FRICTION = 1.5
# Tables of a scene with coefficients of friction, and the key of each.
_RUBBING = (("friction", "coefficient"), ("moments", "friction"), ("elements", "friction"))


def remarks_on(scene: Scene) -> list[str]:
    """What an engineer would ask back about a scene, one sentence each."""
    found, numbers = [], scene_numbers(scene)
    for table, key in _RUBBING:
        for name, part in getattr(scene, table).items():
            path = f"{table}.{name}.{key}"
            # The friction of some elements is a force.
            value = getattr(part, key, None) if path in numbers and numbers[path].dimension == "number" else None
            if isinstance(value, float) and value > MOST_FRICTION:
                found.append(
                    f"{path} = {value:g}: coefficients of friction hardly exceed {MOST_FRICTION:g}; is it a percentage?"
                )
    for name, cylinder in scene.cylinders.items():
        if cylinder.type == "pump" and cylinder.suction > cylinder.discharge:
            found.append(
                f"cylinders.{name}: suction is above discharge, so the liquid drives the machine; is it meant?"
            )
    return found
