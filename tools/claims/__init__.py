"""Whether the product shows what it claims: sessions at many seeds, without their switch, and with mutants of the code."""
