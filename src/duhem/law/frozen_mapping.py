"""A mapping that a frozen value can hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn, TypeVar

__all__ = ["FrozenMapping"]

K = TypeVar("K")
V = TypeVar("V")


class FrozenMapping(dict[K, V]):
    """A dictionary that is never changed: it has a hash if its values have one; ``|`` and ``copy`` give dictionaries that may change."""

    __slots__ = ()

    def __init__(self, content: Mapping[K, V] | None = None) -> None:
        super().__init__(content or {})

    def _refused(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{type(self).__name__} is never changed")

    __setitem__ = __delitem__ = clear = pop = popitem = setdefault = update = _refused

    def __or__(self, other: Any) -> Any:
        return dict(self) | other

    __ior__ = __or__

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    def __reduce__(self) -> tuple[Any, ...]:
        """Made anew of a dictionary, as a copy is not filled entry by entry."""
        return type(self), (dict(self),)
