"""Results, positions, histories and cams as files for other programs."""
