"""The ways to the closest point that there are, cheapest first; each is imported when it is asked for, so that names cost nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from duhem.projection.method import Method

__all__ = ["METHODS"]


def _closed_form() -> Method[Any]:
    from duhem.projection.closed_form import CLOSED_FORM

    return CLOSED_FORM


def _newton() -> Method[Any]:
    from duhem.projection.newton import NEWTON

    return NEWTON


def _cvxpy() -> Method[Any]:
    from duhem.projection.cvxpy_method import CVXPY

    return CVXPY


METHODS: Mapping[str, Callable[[], Method[Any]]] = MappingProxyType(
    {
        "closed-form": _closed_form,
        "newton": _newton,
        "cvxpy": _cvxpy,
    }
)
