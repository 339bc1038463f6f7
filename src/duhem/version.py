"""The versions of the package and of what it may use, for whoever reports them."""

from __future__ import annotations

__all__ = ["__version__", "distribution"]

__version__ = "0.1.0"


def distribution(name: str) -> str | None:
    """The version of an installed distribution, of one such as ``cvxpy-base`` also as ``cvxpy``; None where there is none."""
    from importlib.metadata import PackageNotFoundError, version  # takes longer than all else that duhem --help imports

    for candidate in dict.fromkeys((name, name.removesuffix("-base"))):
        try:
            return version(candidate)
        except PackageNotFoundError:
            continue
    return None
