"""Derived forms of one law, each computed at most once and shared by the methods."""
