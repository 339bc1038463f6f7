"""Expressions of Python as C99: each operation the one of C that rounds as Python's does, in the same order."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass

from duhem.expression.elementary import ELEMENTARY

__all__ = ["CHOICE", "OPERATORS", "PREFIX", "TYPES", "Array", "Expression", "NotTranslated", "named"]

OPERATORS: Mapping[type, tuple[str, int]] = {
    ast.Or: ("||", 1),
    ast.And: ("&&", 2),
    ast.Eq: ("==", 3),
    ast.NotEq: ("!=", 3),
    ast.Lt: ("<", 4),
    ast.LtE: ("<=", 4),
    ast.Gt: (">", 4),
    ast.GtE: (">=", 4),
    ast.Add: ("+", 5),
    ast.Sub: ("-", 5),
    ast.Mult: ("*", 6),
    ast.Div: ("/", 6),
    ast.Mod: ("%", 6),
}
CHOICE, PREFIX, _ATOM = 0, 7, 8  # how tightly the others bind

_FUNCTIONS = {word.numpy: word.name for word in ELEMENTARY.values()} | {name: name for name in ("sqrt", "hypot", "floor", "ldexp")}
_FUNCTIONS |= {"arctan2": "atan2", "abs": "fabs", "max": "larger", "min": "smaller"}
_NUMBERS = {"nan": "NAN", "inf": "INFINITY"}
_KEYWORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long register restrict return short
signed sizeof static struct switch typedef union unsigned void volatile while
"""
_RESERVED = frozenset(_KEYWORDS.split())
TYPES = {"float": "double", "int": "int", "bool": "int", "None": "void"}


class NotTranslated(Exception):
    """A construction that has no C here: a fault of the text, not of a user."""


@dataclass(frozen=True)
class Array:
    """What a name holds: the type of the entries, and how many there are in each direction, as C."""

    element: str
    sizes: tuple[str, ...]
    read_only: bool = False

    def declared(self, name: str) -> str:
        """As a local array."""
        return f"{self.element} {name}{''.join(f'[{size}]' for size in self.sizes)}"

    def passed(self, name: str) -> str:
        """As a parameter."""
        head = f"{'const ' * self.read_only}{self.element}"
        return f"{head} *{name}" if len(self.sizes) == 1 else f"{head} {name}[]{''.join(f'[{size}]' for size in self.sizes[1:])}"


class Expression:
    """Expressions as C, by precedence; ``kind`` says of one whether it is an ``int`` or a ``double``."""

    def __init__(self, functions: Mapping[str, str], arrays: Mapping[str, Array], names: dict[str, str]) -> None:
        self.functions, self.arrays, self.kinds = functions, arrays, names

    def of(self, node: ast.expr, least: int = CHOICE) -> str:
        """In brackets where it binds less than ``least``."""
        text, binds = self._text(node)
        return text if binds >= least else f"({text})"

    def _text(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Constant(value=bool(value)):
                return str(int(value)), _ATOM
            case ast.Constant(value=int() | float() as value):
                return repr(value), _ATOM
            case ast.Name(id=name):
                return self.named(name), _ATOM
            case ast.Attribute(attr=name) if name in _NUMBERS:
                return _NUMBERS[name], _ATOM
            case ast.UnaryOp(op=ast.Not(), operand=x):
                return f"!{self.of(x, PREFIX)}", PREFIX
            case ast.UnaryOp(op=ast.USub(), operand=x):
                return f"-{self.of(x, _ATOM)}", PREFIX
            case ast.BinOp(left=a, op=ast.Pow(), right=b):
                return f"pow({self.of(a)}, {self.of(b)})", _ATOM
            case ast.BinOp(left=a, op=op, right=b) if type(op) in OPERATORS:
                sign, binds = OPERATORS[type(op)]
                if sign in "/%" and (sign == "%") != (self.kind(a) == self.kind(b) == "int"):
                    raise NotTranslated(ast.unparse(node))
                return f"{self.of(a, binds)} {sign} {self.of(b, binds + 1)}", binds
            case ast.BoolOp(op=op, values=values):
                sign, binds = OPERATORS[type(op)]
                return f" {sign} ".join(self.of(value, 3) for value in values), binds
            case ast.Compare(left=left, ops=ops, comparators=others):
                ends = [left, *others]
                each = []
                for a, comparison, b in zip(ends, ops, others, strict=False):
                    sign, binds = OPERATORS[type(comparison)]
                    each.append((f"{self.of(a, 5)} {sign} {self.of(b, 5)}", binds))
                return each[0] if len(each) == 1 else (" && ".join(text for text, _ in each), 2)
            case ast.IfExp(test=test, body=body, orelse=otherwise):
                return f"{self.of(test, 1)} ? {self.of(body, 1)} : {self.of(otherwise)}", CHOICE
            case ast.Subscript(value=ast.Call(func=ast.Name(id="frexp"), args=[x]), slice=ast.Constant(value=1)):
                return f"binary_exponent({self.of(x)})", _ATOM
            case ast.Subscript(value=ast.Name(id=name), slice=place):
                places = place.elts if isinstance(place, ast.Tuple) else [place]
                if name not in self.arrays or len(places) != len(self.arrays[name].sizes):
                    raise NotTranslated(ast.unparse(node))
                return named(name) + "".join(f"[{self.of(i)}]" for i in places), _ATOM
            case ast.Call(func=ast.Name(id="float" | "int" as name), args=[x]):
                return f"({TYPES[name]}){self.of(x, _ATOM)}", PREFIX
            case ast.Call(func=ast.Name(id=name), args=args) if name in self.functions or name in ("isfinite", *_FUNCTIONS):
                kinds = [self.kind(a) for a in args] if name in ("abs", "max", "min") else []
                if "int" in kinds:
                    raise NotTranslated(ast.unparse(node))
                own = name if name in self.functions else _FUNCTIONS.get(name, name)
                return f"{own}({', '.join(self.of(a) for a in args)})", _ATOM
        raise NotTranslated(ast.unparse(node))

    def kind(self, node: ast.expr) -> str:
        """``int`` or ``double``; bools are ints."""
        match node:
            case ast.Constant(value=value):
                return "double" if isinstance(value, float) else "int"
            case ast.Name(id=name):
                return "double" if name in _NUMBERS else self.kinds.get(name, "int")
            case ast.Subscript(value=ast.Name(id=name)):
                return "double" if self.arrays[name].element == "double" else "int"
            case ast.UnaryOp(op=ast.USub(), operand=x):
                return self.kind(x)
            case ast.BinOp(left=a, op=op, right=b) if not isinstance(op, ast.Div | ast.Pow):
                return "double" if "double" in (self.kind(a), self.kind(b)) else "int"
            case ast.IfExp(body=a, orelse=b):
                return "double" if "double" in (self.kind(a), self.kind(b)) else "int"
            case ast.Call(func=ast.Name(id=name)) if name in ("int", "isfinite") or self.functions.get(name) == "int":
                return "int"
            case ast.UnaryOp() | ast.BoolOp() | ast.Compare() | ast.Subscript():
                return "int"
        return "double"

    def named(self, name: str) -> str:
        return _NUMBERS.get(name) or named(name)


def named(name: str) -> str:
    """A name that C leaves free."""
    return f"{name}_" if name in _RESERVED else name
