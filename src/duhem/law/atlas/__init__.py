"""The atlas: laws as they are published, one criterion file each, in a folder a group; a file placed here is a law of the atlas."""
