"""Methods of proof and refutation, one idea a module; each answers with evidence or with None: it cannot say."""
