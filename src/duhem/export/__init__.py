"""A law's increment as source for other programs: C99, and Fortran on top of it."""
