"""Elements in which dry friction decides: screws, belts, wedges, inclines, journals, guides, rollers, cars."""
