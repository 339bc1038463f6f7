"""What a law is: a frozen value over a formula or a boundary curve, its domains, its file, and the catalogue of all of them."""
