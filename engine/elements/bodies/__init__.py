"""Single rotating bodies: inertia about any axes, a body sliding on a rotating guide, wound flywheels."""
