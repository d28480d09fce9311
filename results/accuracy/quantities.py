"""Groups of similar summaries, and of machines with similar loads."""

LOADS = {
    "smooth": ("slider-crank", "crank-rocker", "swinging block"),
    "kinks": ("compressor", "turning moment", "Watt six-bar"),
    "jumps": ("press", "rubbed crank-rocker", "toggle press", "crank shaper", "Scotch yoke"),
}
KINEMATIC = ("velocity", "acceleration", ".x")


def class_of(name: str) -> str:
    """Name of a summary's group in tables."""
    field, _, what = name.rpartition(".")
    if what in ("min_at", "max_at"):
        return "positions of extremes [rad]"
    if what in ("min", "max", "mean", "rms"):
        size = "extremes" if what in ("min", "max") else "mean, rms"
        return f"{_field(field)}: {size}"
    if what.startswith(("stroke", "swing")):
        if what.endswith("_at"):
            return "dead centres [rad]"
        return "quick-return ratio" if what.endswith("ratio") else "strokes, swings"
    if what.startswith("order_"):
        return "shaking force: orders"
    return {
        "transmission_angle": "transmission angle",
        "required_drive_moment": "required moment and power",
        "required_power": "required moment and power",
        "excess_work": "excess work",
        "excess_work_difference": "flywheels",
        "speed_fluctuation": "speed fluctuation",
        "speed_min": "minimum and maximum speed",
        "speed_max": "minimum and maximum speed",
    }.get(what, "flywheels")


def _field(field: str) -> str:
    if field.endswith(("reaction", "reaction_x")):
        return "reactions"
    if field == "shaking_force":
        return "shaking force"
    if field.endswith(KINEMATIC):
        return "velocities, accelerations"
    return {"reduced_inertia": "I", "reduced_inertia_phi": "dI/dφ"}.get(field, "reduced and input moment")
