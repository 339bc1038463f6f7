"""What is put to the test?  A routine, or a material with a state, what it may answer, and where it can be imported from."""
