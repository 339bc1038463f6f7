"""A law's formula as its text says it: a tree of numbers, names, sums, products, powers and words.  Nothing is simplified.

The kernel's own parser, so that what it checks is the formula as written and not what the prover's algebra made of it.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from duhem.proof.kernel.steps import pay

__all__ = [
    "COMPARISONS", "ENDS", "HALF", "UNREADABLE", "WORDS", "NotWritten", "Term", "bounded", "definitions", "factors", "in_words", "minus",
    "number", "parse", "product_of", "sign_of", "sum_of",
]  # fmt: skip

_OF_ONE = (
    "abs", "sign", "sqrt", "exp", "log", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "pos", "neg",
    "softplus",
)  # fmt: skip
# least and greatest number of arguments
WORDS = {
    **dict.fromkeys(_OF_ONE, (1, 1)), **dict.fromkeys(("norm", "max", "min", "logsumexp"), (1, 32)),
    "atan2": (2, 2), "eigmax": (6, 6), "where": (3, 3),
}  # fmt: skip
COMPARISONS = ("<=", ">=", "<", ">")
ENDS = {"abs": (1, -1), "pos": (1, 0), "neg": (-1, 0)}  # what x is multiplied by, the greater of which is the kink of x
_JOINTS = ("and", "or")
_NUMBER = r"(?P<digits>[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE](?P<scale>[+-]?[0-9]+))?"
_TOKEN = re.compile(rf"[ \t\n\r]*(?P<token>(?P<number>{_NUMBER})|[^\W\d]\w*|\*\*|<=|>=|[-+*/(),<>])(?!=|(?<=/)/)")
_BLANKS = " \t\n\r"
_DEEPEST, _BRACKETS, _LARGEST = 200, 60, 8_000  # signs and powers; brackets; parts of what repeats some of the text
_MOST_CHARACTERS, _MOST_TOKENS, _MOST_DIGITS = 20_000, 4_000, 400
_MOST_PARTS = 20_000  # of a tree that is gone through part by part; several times what one text can say
_MOST_DEFINITIONS = 20_000
_Reader = Callable[[list[str], int, int], "tuple[Term, int]"]
_SAID = 120  # letters of what somebody wrote that a message repeats


class NotWritten(Exception):
    """The text is no formula of the vocabulary."""


UNREADABLE = (NotWritten, KeyError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError)
"""What reading something that anybody may have written ends with."""


def in_words(fault: Exception) -> str:
    """What is wrong with what was read, for its reader: one of ``UNREADABLE`` without Python's names."""
    if isinstance(fault, NotWritten):
        said = str(fault)
        return said if len(said) <= _SAID else f"{said[: _SAID // 2]} ... {said[-_SAID // 2 :]}"
    if isinstance(fault, KeyError):
        key = fault.args[0] if fault.args else None
        return f"{key[:_SAID]!r} is not there" if isinstance(key, str) else "something that it names is not there"
    told = {RecursionError: "it nests too deeply", ArithmeticError: "a number in it cannot be reckoned with"}
    other = "something else stands where a text, a number, a list or an object should"
    return next((said for kind, said in told.items() if isinstance(fault, kind)), other)


class _Parts(NamedTuple):
    op: str
    args: tuple[Term, ...] = ()
    value: Fraction = Fraction(0)
    name: str = ""


class Term(_Parts):
    """``op``: ``number`` (``value``), ``name`` (``name``), ``+``, ``*``, ``**`` (base, exponent), a comparison or a word.

    ``sqrt``, ``log10``, ``sign``, ``softplus``, ``logsumexp`` and what joins comparisons are read as what they mean in the others.
    """

    _hash: int  # as these are asked for without end, each is found once
    _names: frozenset[str]
    _size: int
    _made: dict[Term, Term]

    def __hash__(self) -> int:
        """Of what is equal where the terms are; that of a fraction takes long."""
        try:
            return self._hash
        except AttributeError:
            self._hash = hash((self.op, self.args, self.value.numerator, self.name))
            return self._hash

    def parts(self) -> Iterator[Term]:
        """Every part of the formula once, the inner ones first and the formula last."""
        return self._parts(set())

    def _parts(self, seen: set[Term]) -> Iterator[Term]:
        for a in self.args:
            if a not in seen:
                yield from a._parts(seen)
        seen.add(self)
        yield self

    def names(self) -> frozenset[str]:
        """Every name in the tree."""
        try:
            return self._names
        except AttributeError:
            self._names = frozenset({self.name} if self.op == "name" else ()).union(*(a.names() for a in self.args))
            return self._names

    def __getstate__(self) -> None:
        """The parts are all of it: another process has other hashes."""

    def size(self) -> int:
        """How many parts the tree has, written out: of a shared part each time that it stands there."""
        try:
            return self._size
        except AttributeError:
            self._size = 1 + sum(a.size() for a in self.args)
            return self._size

    @property
    def large(self) -> bool:
        """Whether it can be gone through as a graph alone, each shared part once: written out as a tree it is too long."""
        return self.size() > _MOST_PARTS

    def put(self, swap: Mapping[Term, Term]) -> Term:
        """The term with every occurrence of some sub-terms replaced, the largest first; a part in which there is none stays as it is.

        What is shared stays shared.
        """
        if not self.large:
            return self._put(swap, {}, {})
        try:
            made = self._made
        except AttributeError:
            made = self._made = {}  # equal graphs are one object: who compares two goes through them as trees
        return self._put(swap, {}, made)

    def _put(self, swap: Mapping[Term, Term], done: dict[Term, Term], made: dict[Term, Term]) -> Term:
        if self in swap:
            return swap[self]
        if self not in done:
            pay(1)
            args = tuple(a._put(swap, done, made) for a in self.args)
            kept = all(new is old for new, old in zip(args, self.args, strict=True))
            new = self if kept else self._replace(args=args)
            done[self] = made.setdefault(new, new)
        return done[self]


def number(value: Fraction | int) -> Term:
    """A number as a term."""
    return Term("number", value=Fraction(value))


HALF = number(Fraction(1, 2))


def minus(term: Term) -> Term:
    """-x."""
    return number(-term.value) if term.op == "number" else Term("*", (number(-1), term))


def sum_of(*terms: Term) -> Term:
    """x + y + ..., 0 for none."""
    return Term("+", (number(0), *terms))


def product_of(*factors: Term) -> Term:
    """x y ..., 1 for none."""
    return Term("*", (number(1), *factors))


def factors(term: Term) -> list[Term]:
    """What is multiplied, in products within products too; a large one is left as it is."""
    return [f for a in term.args for f in factors(a)] if term.op == "*" and not term.large else [term]


Defined = Mapping[str, Term]  # what names stand for


def parse(text: str, defined: Defined | None = None) -> Term:
    """The formula or comparison in a text; NotWritten where it is none.  x - y is x + (-1) y, x/y is x y**(-1), sqrt(x) is x**(1/2), ...

    A name that is ``defined`` is the term it stands for, the same object wherever it stands.
    """
    tokens = _tokens(text)
    term, rest = _condition(tokens, 0, 0)
    if rest != len(tokens):
        raise NotWritten(f"{tokens[rest]!r} is one too many")
    _place(term, term.op in COMPARISONS)
    return term if not defined else _with_names(term, defined, {})


def _with_names(term: Term, defined: Defined, made: dict[Term, Term]) -> Term:
    """The term, as it was just read, with what names stand for; parts that are alike are one."""
    if term.op == "name":
        return defined.get(term.name, term)
    here = term if not term.args else term._replace(args=tuple(_with_names(a, defined, made) for a in term.args))
    return made.setdefault(here, here)


def definitions(given: Sequence[Sequence[str]], taken: Collection[str]) -> dict[str, Term]:
    """What names stand for, each in terms of those before it; NotWritten where one is no name, or is ``taken`` or used too early.

    Terms that are alike are one, so that a formula of them is a graph and equal ones are compared at once.
    """
    found, made = dict[str, Term](), dict[Term, Term]()
    if len(given) > _MOST_DEFINITIONS:
        raise NotWritten("there are too many definitions")
    left = {name for name, _ in given}
    if len(left) < len(given) or left & {*taken, *WORDS, "pi", *_JOINTS}:
        raise NotWritten("a name is declared twice")
    for name, text in given:
        if not name.isidentifier() or name != unicodedata.normalize("NFKC", name):
            raise NotWritten("a name is none")
        term = parse(text)
        if term.op in COMPARISONS or term.names() & left:
            raise NotWritten("a definition is a comparison, or uses what is not defined before it")
        found[name] = term = _with_names(term, found, made)
        left.discard(name)
        hash(term), term.names(), term.size()  # the inner ones first, so that none is found in depth
    return found


def _tokens(text: str) -> list[str]:
    """The numbers, names and signs of a text; NotWritten for a mark that none of them has, and for too many."""
    if len(text) > _MOST_CHARACTERS:
        raise NotWritten("the formula is too long")
    tokens, at, text, opened = list[str](), 0, text.rstrip(_BLANKS), 0
    while at < len(text):
        found = _TOKEN.match(text, at)
        if found is None:
            raise NotWritten(f"{text[at : at + 20]!r} is not understood")
        token, at = found["token"], found.end()
        if found["number"]:
            _check_number(found["digits"], found["scale"] or "0", text[at : at + 1])
        opened += (token == "(") - (token == ")")
        tokens.append(token)
        if opened > _BRACKETS or len(tokens) > _MOST_TOKENS:
            raise NotWritten("the formula nests too deeply or is too long")
    return tokens


def _check_number(digits: str, scale: str, behind: str) -> None:
    """A number is written out in so many digits, begins with no 0 to no purpose, and no letter touches its end."""
    if len(digits) > _MOST_DIGITS or len(scale) > 6 or abs(int(scale)) > _MOST_DIGITS:
        raise NotWritten("a number is too long or too large")
    if re.fullmatch(r"0+[1-9][0-9]*", digits) or behind.isalpha():
        raise NotWritten(f"{digits[:24]!r} is no number in its place")


def _place(term: Term, condition: bool) -> None:
    """NotWritten where a comparison stands elsewhere than first in a choice, or something else does there."""
    if (term.op in COMPARISONS) != condition or term.op in _JOINTS:
        raise NotWritten("a comparison stands where none should, or is missing")
    for i, part in enumerate(term.args):
        _place(part, term.op == "where" and i == 0)


def _condition(tokens: list[str], at: int, depth: int, joint: str = "or") -> tuple[Term, int]:
    """Comparisons, joined by "and" more closely than by "or"; or a single formula."""
    parts = list[Term]()
    while not parts or tokens[at : at + 1] == [joint]:
        at += bool(parts)
        term, at = _condition(tokens, at, depth, "and") if joint == "or" else _comparison(tokens, at, depth)
        parts.append(term)
    return (parts[0] if len(parts) == 1 else Term(joint, tuple(parts))), at


def _comparison(tokens: list[str], at: int, depth: int = 0) -> tuple[Term, int]:
    left, at = _sum(tokens, at, depth)
    if at < len(tokens) and tokens[at] in COMPARISONS:
        sign = tokens[at]
        right, at = _sum(tokens, at + 1, depth)
        return Term(sign, (left, right)), at
    return left, at


def _sum(tokens: list[str], at: int, depth: int) -> tuple[Term, int]:
    term, at = _signed(_product, tokens, at, depth)
    terms = [term]
    while at < len(tokens) and tokens[at] in "+-":
        sign = tokens[at]
        term, at = _signed(_product, tokens, at + 1, depth)
        terms.append(term if sign == "+" else minus(term))
    return (terms[0] if len(terms) == 1 else Term("+", tuple(terms))), at


def _signed(read: _Reader, tokens: list[str], at: int, depth: int) -> tuple[Term, int]:
    """What a reader reads, perhaps behind signs."""
    if at == len(tokens) or tokens[at] not in "+-":
        return read(tokens, at, depth)
    _check_depth(depth)
    term, end = _signed(read, tokens, at + 1, depth + 1)
    return (term if tokens[at] == "+" else minus(term)), end


def _check_depth(depth: int) -> None:
    if depth > _DEEPEST:
        raise NotWritten("the formula nests too deeply")


def _product(tokens: list[str], at: int, depth: int) -> tuple[Term, int]:
    term, at = _power(tokens, at, depth)
    factors = [term]
    while at < len(tokens) and tokens[at] in ("*", "/"):
        sign = tokens[at]
        term, at = _signed(_power, tokens, at + 1, depth)
        factors.append(term if sign == "*" else Term("**", (term, number(-1))))
    powers = tuple(x if n == 1 else Term("**", (x, number(n))) for x, n in Counter(factors).items())  # x x is x**2
    return (powers[0] if len(powers) == 1 else Term("*", powers)), at


def _power(tokens: list[str], at: int, depth: int) -> tuple[Term, int]:
    base, at = _atom(tokens, at, depth)
    if at < len(tokens) and tokens[at] == "**":
        _check_depth(depth)
        exponent, at = _signed(_power, tokens, at + 1, depth + 1)
        return Term("**", (base, exponent)), at
    return base, at


def _atom(tokens: list[str], at: int, depth: int) -> tuple[Term, int]:
    if at >= len(tokens):
        raise NotWritten("the formula ends too early")
    _check_depth(depth)
    token = tokens[at]
    if token[0] in ".0123456789":
        return number(Fraction(token)), at + 1
    if token == "(":
        term, at = _condition(tokens, at + 1, depth + 1)
        return term, _closed(tokens, at)
    if not token.isidentifier() or token in _JOINTS:
        raise NotWritten(f"{token!r} stands where a value should")
    if at + 1 < len(tokens) and tokens[at + 1] == "(":
        return _call(tokens, at, depth)
    return Term("name", name=unicodedata.normalize("NFKC", token)), at + 1  # as Python spells names


def _call(tokens: list[str], at: int, depth: int) -> tuple[Term, int]:
    word, args = tokens[at], list[Term]()
    least, most = WORDS.get(word, (1, 0))
    at += 1
    while not args or tokens[at : at + 1] == [","]:
        term, at = _condition(tokens, at + 1, depth + 1)
        args.append(term)
    at = _closed(tokens, at)
    if not least <= len(args) <= most:
        raise NotWritten(f"{word} with {len(args)} arguments is no word")
    return _meaning(word, args), at


def _meaning(word: str, args: list[Term]) -> Term:
    x = args[0]
    if word == "sqrt":
        return Term("**", (x, HALF))
    if word == "log10":
        return Term("*", (Term("log", (x,)), Term("**", (Term("log", (number(10),)), number(-1)))))
    if word in ("softplus", "logsumexp"):
        return Term("log", (Term("+", (*([number(1)] if word == "softplus" else []), *(Term("exp", (a,)) for a in args))),))
    if word == "sign":
        below = Term("where", (Term("<", (x, number(0))), number(-1), number(0)))
        return bounded(Term("where", (Term(">", (x, number(0))), number(1), below)))
    return _choice(x, args[1], args[2]) if word == "where" else Term(word, tuple(args))


def sign_of(term: Term) -> Term | None:
    """x where the term is what ``sign(x)`` is read as."""
    found = term.args[0].args[0] if term.op == "where" and term.args[0].op == ">" else None
    return found if found is not None and term == _meaning("sign", [found]) else None


def _choice(condition: Term, a: Term, b: Term) -> Term:
    """a where the condition holds, else b: of p and q, the choice by q where p holds; of p or q, that by q where p does not."""
    if condition.op not in _JOINTS:
        return Term("where", (condition, a, b))
    found = a if condition.op == "and" else b
    for part in reversed(condition.args):
        found = bounded(_choice(part, found, b) if condition.op == "and" else _choice(part, a, found))
    return found


def bounded(term: Term) -> Term:
    """The term, in which parts of the text stand more than once; NotWritten where it has grown too large."""
    if term.size() > _LARGEST:
        raise NotWritten("what is written out is too large")
    return term


def _closed(tokens: list[str], at: int) -> int:
    if tokens[at : at + 1] != [")"]:
        raise NotWritten("a parenthesis is not closed")
    return at + 1
