"""The version of the package, for whoever reports it."""

__all__ = ["__version__"]

__version__ = "0.1.0"
