"""Where jobs run: in this process, in worker processes, or on a Dask cluster. All three give the same rows."""
