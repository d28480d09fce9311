"""Pictures of machine elements: plans of rotors' unbalances, orders that shake engines, governors, gears."""
