"""Running a study on a Dask cluster: who takes part, what is computed where, and what limits it."""
