"""Scripts to start from; tests run them."""
