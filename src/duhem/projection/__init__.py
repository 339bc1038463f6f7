"""Slip increments: the closest point of K to a trial stress, and proof by residuals that it is."""
