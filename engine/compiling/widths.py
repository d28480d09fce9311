"""Widths of parallel work: variants in a block, positions on a panel."""

# Variants in a block. With 64 the loops over lanes are fully vectorised.
LANES = 64
# Positions of a panel, and of each part of a scan.
PANEL_POSITIONS = 17
