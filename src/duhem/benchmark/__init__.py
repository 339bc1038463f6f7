"""How good the slip increments are: error against run time, stiff and extreme cases, against a reference in many digits."""
