"""Verifications of built-in laws over their whole domains, each made once for all tests of a process that read one."""

from __future__ import annotations

from functools import cache

from duhem import Verification, verify

__all__ = ["verified"]


@cache
def verified(name: str) -> Verification:
    return verify(name)
