"""The gradient of a potential, part by part; nothing is simplified but what is multiplied by 0.

At a kink the pieces stand behind a ``where``: what is shown of that holds for the gradient of each piece.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["gradient"]

_ZERO, _ONE = number(0), number(1)


def _to(base: Term, power: Fraction) -> Term:
    return Term("**", (base, number(power)))


_OUTER: dict[str, Callable[[Term, Term], Term]] = {  # slopes of words of one part, by the term and that part
    "exp": lambda term, _: term,
    "log": lambda _, u: _to(u, Fraction(-1)),
    "sin": lambda _, u: Term("cos", (u,)),
    "cos": lambda _, u: minus(Term("sin", (u,))),
    "tan": lambda term, _: sum_of(_ONE, product_of(term, term)),
    "sinh": lambda _, u: Term("cosh", (u,)),
    "cosh": lambda _, u: Term("sinh", (u,)),
    "tanh": lambda _, u: _to(Term("cosh", (u,)), Fraction(-2)),
    "atan": lambda _, u: _to(sum_of(_ONE, product_of(u, u)), Fraction(-1)),
    "asin": lambda _, u: _to(sum_of(_ONE, minus(product_of(u, u))), Fraction(-1, 2)),
    "acos": lambda _, u: minus(_to(sum_of(_ONE, minus(product_of(u, u))), Fraction(-1, 2))),
}


def gradient(potential: Term, forces: Sequence[str]) -> tuple[Term, ...]:
    """The derivatives by ``forces``, each defined only where the potential is; NotWritten for a word without one here."""
    nothing = product_of(_ZERO, potential)
    return tuple(sum_of(_slope(potential, x), nothing) for x in forces)


def _slope(term: Term, x: str) -> Term:
    if x not in term.names():
        return _ZERO
    if term.op == "name":
        return number(1)
    parts = [_ZERO if term.op == "where" and i == 0 else _slope(a, x) for i, a in enumerate(term.args)]
    u, du = term.args[0], parts[0]
    match term.op:
        case "+":
            return sum_of(*(p for p in parts if p != _ZERO))
        case "*":
            rest = [[a for j, a in enumerate(term.args) if j != i] for i in range(len(parts))]
            return sum_of(*(product_of(p, *rest[i]) for i, p in enumerate(parts) if p != _ZERO))
        case "**" if parts[1] == _ZERO:
            exponent = term.args[1]
            less = number(exponent.value - 1) if exponent.op == "number" else sum_of(exponent, number(-1))
            return product_of(exponent, Term("**", (u, less)), du)
        case "norm":
            return product_of(sum_of(*map(product_of, term.args, parts)), Term("**", (term, number(-1))))
        case "eigmax":  # by the adjugate of it less the matrix, a multiple of n n^T with the unit eigenvector n
            a, b, c, yz, xz, xy = (*(sum_of(term, minus(e)) for e in term.args[:3]), *map(minus, term.args[3:]))

            def minor(p: Term, q: Term, r: Term, s: Term) -> Term:
                return sum_of(product_of(p, q), minus(product_of(r, s)))

            diagonal = (minor(b, c, yz, yz), minor(a, c, xz, xz), minor(a, b, xy, xy))
            doubled = (minor(xy, xz, a, yz), minor(xy, yz, b, xz), minor(xz, yz, c, xy))  # a shear stands twice in the matrix
            over = [*diagonal, *(product_of(number(2), m) for m in doubled)]
            return product_of(sum_of(*map(product_of, over, parts)), Term("**", (sum_of(*diagonal), number(-1))))
        case word if word in _OUTER:
            return product_of(_OUTER[word](term, u), du)
        case "abs" | "pos" | "neg":
            above, below = _ZERO if term.op == "neg" else du, _ZERO if term.op == "pos" else minus(du)
            return Term("where", (Term(">=", (u, _ZERO)), above, below))
        case "max" | "min" if len(term.args) == 1:
            return du
        case "max" | "min":
            rest_of = Term(term.op, term.args[1:])
            one, two = (u, rest_of) if term.op == "max" else (rest_of, u)
            return Term("where", (Term(">=", (one, two)), du, _slope(rest_of, x)))
        case "where":
            return Term("where", (u, parts[1], parts[2]))
    raise NotWritten(f"{term.op} has no derivative here")
