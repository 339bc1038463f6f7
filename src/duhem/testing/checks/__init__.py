"""What must hold?  Facts in a registry, each measured on the replies of one routine to one case, or on all that was visited."""
