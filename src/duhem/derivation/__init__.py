"""What follows symbolically from a law's formula: potential, state laws, evolution law, increment."""
