"""Built-in laws, one per file: criterion files, and Python for a law that such a file cannot state.  A new file here is a new law."""
