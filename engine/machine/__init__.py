"""From a scene to its mathematics: kinematics, masses, loads, reactions, friction; and what may be asked."""
