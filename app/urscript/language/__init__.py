"""From text to a tree: grammar, positions, errors of syntax."""
