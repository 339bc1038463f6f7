"""Built-in laws, one per file; a file placed here is a law of the catalogue."""
