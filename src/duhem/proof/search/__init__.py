"""Where a violation might be, in floating point.  What is found here suggests; nothing here decides."""
