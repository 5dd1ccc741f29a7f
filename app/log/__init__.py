"""log.mcap: what a run looked like, tick by tick, for Foxglove, for replay and for numpy. Uses files/, mcap_file/."""
