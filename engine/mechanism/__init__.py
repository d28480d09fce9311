"""From a scene to its graph: kinematics, masses, loads, reactions and friction, each as nodes."""
