"""What does pytest see of it?  Marked routines, criterion and scene files, and snapshots as tests; imported where one is met."""
