"""Running a study on a Dask cluster."""
