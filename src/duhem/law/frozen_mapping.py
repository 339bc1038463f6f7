"""A mapping that a frozen value can hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

__all__ = ["FrozenMapping"]

K = TypeVar("K")
V = TypeVar("V")


class FrozenMapping(Mapping[K, V]):
    """Like the dictionary it is made of, but never changed: it has a hash if its values have one, and can be pickled and copied."""

    __slots__ = ("_content",)

    def __init__(self, content: Mapping[K, V] | None = None) -> None:
        self._content = dict(content or {})

    def __getitem__(self, key: K) -> V:
        return self._content[key]

    def __iter__(self) -> Iterator[K]:
        return iter(self._content)

    def __reversed__(self) -> Iterator[K]:
        return reversed(self._content)

    def __len__(self) -> int:
        return len(self._content)

    def __or__(self, other: Any) -> dict[K, V]:
        """What dictionaries give, and so a dictionary; the same for ``other | self`` and for :meth:`copy`."""
        return self._content | (other._content if isinstance(other, FrozenMapping) else other)

    def __ror__(self, other: Any) -> dict[K, V]:
        return other | self._content

    def copy(self) -> dict[K, V]:
        """A dictionary of its own, to be changed at will."""
        return dict(self._content)

    def __hash__(self) -> int:
        return hash(frozenset(self._content.items()))

    def __repr__(self) -> str:
        return repr(self._content)
