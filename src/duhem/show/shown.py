"""What a result offers its user and a notebook, whatever it is."""

from __future__ import annotations

from typing import Any, ClassVar

__all__ = ["Shown"]


class Shown:
    """A result whose ``printed_by`` names the module that registers its printers; nothing of it is imported before it is shown."""

    printed_by: ClassVar[str]

    def to_text(self) -> str:
        """The result for people, in plain text."""
        from duhem.show.printing import text

        return text(self)

    def to_html(self) -> str:
        """The result as a piece of HTML with all text escaped and formulas as text."""
        from duhem.show.printing import html

        return html(self)

    def to_dict(self) -> dict[str, Any]:
        """The result in plain values, ready for JSON; exact numbers as text such as ``3/20``."""
        from duhem.show.printing import plain

        return plain(self)

    def _repr_html_(self) -> str:
        from duhem.show.printing import html

        return html(self, typeset=True)

    def _repr_markdown_(self) -> str:
        from duhem.show.printing import markdown

        return markdown(self)
