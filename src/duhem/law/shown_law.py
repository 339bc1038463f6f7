"""What every law shows of itself: one line, a sheet, and its boundary as a formula."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from duhem.law.domain import Domain
from duhem.show.shown import Shown

__all__ = ["ShownLaw"]

_MOST = 4  # parameters in one line


class ShownLaw(Shown):
    """A law is shown by ``law_sheet``, which is imported when that is asked."""

    printed_by: ClassVar[str] = "duhem.law.law_sheet"

    name: str
    forces: tuple[str, ...]
    parameters: Mapping[str, Domain]

    def __repr__(self) -> str:
        said = [domain.stated(name) for name, domain in self.parameters.items()]
        more = [f"and {len(said) - _MOST} more"] if len(said) > _MOST else []
        return f"<{type(self).__name__} {self.name}: {', '.join(self.forces)}; {', '.join(said[:_MOST] + more) or 'no parameter'}>"

    def _repr_latex_(self) -> str:
        from duhem.show.printing import latex

        return rf"$\displaystyle {latex(self)}$"
