"""Export of results, positions, histories and cams."""
