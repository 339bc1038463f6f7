"""Methods of proof and refutation; each answers with evidence or with None: it cannot say."""
