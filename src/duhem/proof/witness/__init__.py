"""Whether a find is a violation, at exact points with enclosed signs.  Only what passes here refutes."""
