"""Checks that are known to fail: what fails as expected, what may fail or pass with it, and what is expected in vain."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

__all__ = ["Expectation"]


@dataclass(frozen=True)
class Expectation:
    """``reasons`` by the name of a check, held against the checks that ``failed`` and what each of them explains (``explained_by``).

    Which of the checks that a cause explains fail with it depends on the cases that were drawn, so that they may fail or pass.
    """

    reasons: Mapping[str, str]
    failed: Collection[str]
    explained_by: Callable[[str, Collection[str]], Collection[str]]
    likely: Mapping[str, str] = field(init=False)

    def __post_init__(self) -> None:
        causes = [name for name in self.reasons if name in self.failed]
        explained = {name: cause for cause in causes[::-1] for name in self.explained_by(cause, self.failed)}
        object.__setattr__(self, "likely", {name: f"likely for the same reason as [{cause}]" for name, cause in explained.items()})

    @property
    def met(self) -> dict[str, str]:
        """The checks that failed as expected, or with one of those, and why."""
        return {name: why for name, why in {**self.likely, **self.reasons}.items() if name in self.failed}

    def unmet(self, passed: Collection[str]) -> dict[str, str]:
        """Those of the checks that ``passed`` that had to fail."""
        return {name: why for name, why in self.reasons.items() if name in passed and name not in self.likely}

    def told(self, left_out: Mapping[str, str]) -> dict[str, str]:
        """Why checks are left out, and which of them are expected to fail in vain."""
        vain = self.reasons.keys() - self.likely.keys()
        return {name: f"{why}; so it is expected to fail in vain" if name in vain else why for name, why in left_out.items()}
