"""Text reports, tables and exports of studies and results."""
