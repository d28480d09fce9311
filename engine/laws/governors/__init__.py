"""Speed governors: kinematics of balls and sleeve, controlling force, motion, stability with an engine."""
