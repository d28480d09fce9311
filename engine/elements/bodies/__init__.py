"""Single bodies that turn: their inertia about any axes, bodies that slide on a turning guide, wound flywheels."""
