"""What is asked: a law as a question over positive pressure magnitude, and the simplest question equivalent to it."""
