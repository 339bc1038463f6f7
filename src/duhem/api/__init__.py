"""Increments and paths of laws of which it is asked first whether K is convex: to be stationary is to be closest there alone."""
