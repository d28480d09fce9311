"""Torsional trains: masses, shafts and gears, in a chain or branched; natural frequencies, modes, forced vibration."""
