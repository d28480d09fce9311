"""One mass on a spring with a damper: free and forced vibration, and passage through resonance."""
