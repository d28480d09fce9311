"""Elements governed by dry friction: screws, belts, wedges, inclines, journals, guides, rollers, cars."""
