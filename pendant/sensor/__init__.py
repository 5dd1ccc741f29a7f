"""The flange sensor: what the maker says of it, its zero, and what tells a hand from its errors. Uses limits/."""
