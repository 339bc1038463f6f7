"""What has changed?  A law's text, verdicts and some increments, kept in a file and compared."""
