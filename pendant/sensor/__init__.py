"""The flange sensor's zero: what the maker says of it, taring, its bias in free-drive. Uses limits/."""
