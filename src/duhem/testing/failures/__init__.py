"""What is wrong with it?  Failures by cause, each beside the closest point, with what the routine may do instead, and as a test file."""
