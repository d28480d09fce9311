"""One mass on a spring with a damper: free, forced, run through its resonance."""
