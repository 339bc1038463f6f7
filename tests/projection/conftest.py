"""Numbers of mpmath in 160 digits, for the tests that ask for them."""

from __future__ import annotations

from collections.abc import Iterator

import mpmath
import pytest


@pytest.fixture
def many_digits() -> Iterator[None]:
    with mpmath.workdps(160):
        yield
