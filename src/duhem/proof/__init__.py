"""Whether a law is admissible: claims, the methods that settle them, and the verdicts, each with what it rests on."""
