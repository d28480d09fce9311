"""Units of measurement: read as people type them, and shown in one system, chosen once for each scene."""
