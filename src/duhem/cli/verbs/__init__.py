"""The verbs, one per file: a module placed here, with a command of the same name in it, is a verb of the command line."""
