"""How anything is shown: one table printer, one figure style, one way to save.  Nothing here knows what is shown."""
