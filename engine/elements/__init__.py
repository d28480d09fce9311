"""Machine elements alone: screws, belts, wedges, journals, rotors, engines."""
