"""A verification as text for people and as JSON for programs."""
