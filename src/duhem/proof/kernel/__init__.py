"""A small checker of finished proofs.  It reads a law's text itself and shares nothing with what made the proof.

No SymPy, no solver, no method of proof; fractions only.  What it confirms holds for the formula as written.
"""
