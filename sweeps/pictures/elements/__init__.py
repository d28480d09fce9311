"""Pictures of machine elements: plans of rotors, orders that shake engines, governors, springs, gears, cams."""
