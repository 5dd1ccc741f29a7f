"""What compiled kernels are made of: records of named arrays, and their cache on disk."""
