"""Which increments is a routine asked?  Cases of a law: drawn from its boundary, seams and parameters, and made short when one fails."""
