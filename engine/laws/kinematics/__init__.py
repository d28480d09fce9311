"""Kinematics of rigid links and structural groups: positions, rates, reactions, closure."""
