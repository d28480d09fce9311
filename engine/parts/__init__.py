"""What a scene may hold: models of its parts, with their quantities, units and formulas."""
