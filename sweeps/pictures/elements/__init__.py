"""Pictures of machine elements: plans of rotors' unbalances, sheets of the orders that shake engines."""
