"""What is said of a claim that stays open: the part of the formula that no rule reads, where it is closest to fail, what helps."""
