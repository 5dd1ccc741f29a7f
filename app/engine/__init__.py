"""The one way to run many: work spread over processes and machines by Dask, checked to run the same source. Uses files/."""
