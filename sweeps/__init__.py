"""Studies over machines: sampling, execution, HDF5 results, pictures, command line."""
