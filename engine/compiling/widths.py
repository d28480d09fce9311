"""How much is computed side by side."""

# Variants. With 64 the loops over lanes are vectorised whole.
LANES = 64
# Positions of a panel, and of each part of a scan.
PANEL_POSITIONS = 17
