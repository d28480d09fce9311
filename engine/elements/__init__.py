"""Machine elements: models and laws of what needs no mechanism, or stands beside one."""
