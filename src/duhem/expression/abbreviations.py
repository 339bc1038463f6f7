"""Names that stand for a formula and invariants of a stress, written out in brackets before a formula is read.

What is read, simplified, proved and checked is a formula of the vocabulary alone; nothing further on knows an abbreviation.

An invariant is that of a tensor: of the stress, or of a sum of multiples of tensors, each of which has all of its components declared.

Tension is positive, stresses in one unit.  ``3d`` is the symmetric tensor sigma with the components xx, yy, zz, yz, xz, xy; ``plane``
is plane stress, the same tensor with sigma_zz = sigma_yz = sigma_xz = 0; ``principal`` are its principal stresses 1, 2, 3 in no order.

Each shear component stands once among the forces.  Its work-conjugate is the engineering strain gamma_xy = 2 epsilon_xy, so that
sum_i sigma_i d_i over the listed components is the inner product sigma : epsilon of the tensors.  The derivative of g by the listed
sigma_xy is twice the tensor's component, a shear strain again: the normality rule in the listed components is the tensor's.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from duhem.errors import InputError
from duhem.expression.number import DECIMAL
from duhem.expression.spelling import spelled

__all__ = ["INVARIANTS", "KINDS", "NONE", "Abbreviations", "Stress", "WrittenOut", "names_in"]

KINDS: Mapping[str, tuple[str, ...]] = {
    "3d": ("xx", "yy", "zz", "yz", "xz", "xy"),
    "plane": ("xx", "yy", "xy"),
    "principal": ("1", "2", "3"),
}
_ENDS = ("xx", "yy", "zz", "yz", "xz", "xy", "zy", "zx", "yx", "1", "2", "3")  # of names that may be meant for components
_MOST_OF_A_COMPONENT = 5_000  # letters, where definitions are written out


@dataclass(frozen=True)
class Stress:
    """The stress tensor ``name`` (so that its components are name_xx ...) of one of the ``KINDS``."""

    name: str
    kind: str

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise InputError(f"{self.name!r} is no name of a stress", remedy="use letters, digits and underscores")
        object.__setattr__(self, "name", spelled(self.name))
        if not isinstance(self.kind, str) or self.kind not in KINDS:
            raise InputError(f"{self.kind!r} is no kind of stress", remedy=f"kinds are: {', '.join(KINDS)}")

    @property
    def components(self) -> tuple[str, ...]:
        """The names of the forces that a law of this stress has."""
        return tuple(f"{self.name}_{end}" for end in KINDS[self.kind])

    @property
    def shears(self) -> tuple[bool, ...]:
        """Which of the components are shear stresses, whose conjugate is an engineering strain."""
        return tuple(len(set(end)) == 2 for end in KINDS[self.kind])

    @property
    def unit_stiffness(self) -> tuple[float, ...]:
        """Stress a conjugate, where one number, 1, is the stiffness of the tensors: 1/2 for a shear, whose conjugate is 2 epsilon."""
        return tuple(0.5 if shear else 1.0 for shear in self.shears)

    def written_out(self, word: str, index: int | None = None) -> str:
        """An invariant as a formula in the components; ``index`` from 1 is that of ``principal``, the greatest first."""
        return Tensor(self.kind, self.components).written_out(word, index)


class Tensor(NamedTuple):
    """The components of one ``kind``, each a name or a formula in brackets: of the stress, or of a sum such as sigma - alpha."""

    kind: str
    components: tuple[str, ...]

    def written_out(self, word: str, index: int | None = None) -> str:
        """An invariant, as :meth:`Stress.written_out`."""
        return _principal(self, index) if index is not None else INVARIANTS[word].text(self)


@dataclass(frozen=True)
class Invariant:
    """A word that takes a tensor; ``text`` gives its formula, ``indexed`` says that it takes a number as well."""

    text: Callable[[Tensor], str]
    meaning: str
    indexed: bool = False


def _trace(tensor: Tensor) -> str:
    return " + ".join(tensor.components[: 2 if tensor.kind == "plane" else 3])


def _det(tensor: Tensor) -> str:
    if tensor.kind == "plane":
        x, y, xy = tensor.components
        raise InputError("det of plane stress is 0", remedy=f"that in the plane is {x}*{y} - {xy}**2")
    x, y, z, *shear = tensor.components
    return f"{x}*{y}*{z}" + (_shear_terms(x, y, z, *shear) if shear else "")


def _shear_terms(x: str, y: str, z: str, yz: str, xz: str, xy: str) -> str:
    """What shear adds to the product of the diagonal in a determinant."""
    return f" + 2*{yz}*{xz}*{xy} - {x}*{yz}**2 - {y}*{xz}**2 - {z}*{xy}**2"


def _second(tensor: Tensor) -> str:
    """A sum of squares, so that its sign and curvature are seen."""
    x, y, *rest = tensor.components
    if tensor.kind == "plane":
        return f"(({x} - {y})**2 + {x}**2 + {y}**2)/6 + {rest[0]}**2"
    z, *shear = rest
    return f"(({x} - {y})**2 + ({y} - {z})**2 + ({z} - {x})**2)/6" + "".join(f" + {s}**2" for s in shear)


def _third(tensor: Tensor) -> str:
    if tensor.kind == "plane":
        x, y, xy = tensor.components
        return f"({x} + {y})*(9*{xy}**2 - (2*{x} - {y})*(2*{y} - {x}))/27"
    x, y, z, *shear = tensor.components
    deviator = [f"(2*{a} - {b} - {c})" for a, b, c in ((x, y, z), (y, z, x), (z, x, y))]
    return f"{'*'.join(deviator)}/27" + (_shear_terms(*(f"{s}/3" for s in deviator), *shear) if shear else "")


def _cos3theta(tensor: Tensor) -> str:
    return f"3*sqrt(3)/2*({_third(tensor)})/({_second(tensor)})**(3/2)"


def _principal(tensor: Tensor, index: int) -> str:
    if tensor.kind == "3d":
        greatest = f"eigmax({', '.join(tensor.components)})"
        least = f"eigmax({', '.join(f'-{x}' for x in tensor.components)})"  # less its negative
        return {1: greatest, 2: f"{_trace(tensor)} - {greatest} + {least}", 3: f"-{least}"}[index]
    if tensor.kind == "plane":
        x, y, xy = tensor.components
        if index == 3:
            raise InputError("the third principal stress of plane stress is 0", remedy="1 and 2 are those in the plane, the greater first")
        return f"({x} + {y})/2 {'+' if index == 1 else '-'} norm(({x} - {y})/2, {xy})"
    listed = ", ".join(tensor.components)
    greatest, least = f"max({listed})", f"min({listed})"
    return {1: greatest, 2: f"{_trace(tensor)} - {greatest} - {least}", 3: least}[index]


INVARIANTS: Mapping[str, Invariant] = {
    "I1": Invariant(_trace, "trace"),
    "tr": Invariant(_trace, "trace"),
    "det": Invariant(_det, "determinant"),
    "J2": Invariant(_second, "half the square of the deviator, s:s/2"),
    "J3": Invariant(_third, "determinant of the deviator"),
    "cos3theta": Invariant(_cos3theta, "3*sqrt(3)/2*J3/J2**(3/2), 1 in triaxial tension, -1 in compression"),
    "lode": Invariant(lambda tensor: f"acos({_cos3theta(tensor)})/3", "Lode angle acos(cos3theta)/3 (rad), from 0 to pi/3"),
    "principal": Invariant(_trace, "principal stress 1, 2 or 3, the greatest first", indexed=True),
}


_TOKEN = re.compile(rf"(?P<number>{DECIMAL})|(?P<name>[^\W\d]\w*)")


def names_in(text: str) -> set[str]:
    """Every name in a formula."""
    return {spelled(token[0]) for token in _TOKEN.finditer(text) if token.lastgroup == "name"}


def _arguments(text: str, at: int) -> tuple[list[str], int]:
    """What stands between the commas of the brackets that open at ``at``, and where these end; nothing where none do."""
    depth, begin, found = 0, at, list[str]()
    for i in range(at, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0 and not text[i].isspace():
            return [*found, text[begin:i].strip()] if text[i] == ")" else [], i + 1
        if depth == 1 and text[i] in "(,":
            found += [text[begin:i].strip()] if text[i] == "," else []
            begin = i + 1
    return [], at


@dataclass(frozen=True)
class WrittenOut:
    """A formula without abbreviations, and the ``source`` it was made of.

    ``seams`` are places (in the text, in the source, whether what begins there was copied): in order, each up to the next.
    """

    text: str
    source: str
    seams: tuple[tuple[int, int, bool], ...]

    def origin(self, at: int) -> int:
        """Where in the source a place of the text comes from: inside of an abbreviation, where that stands."""
        here, there, copied = self._seam(at)
        return there + (at - here) * copied

    def abbreviation(self, at: int) -> str | None:
        """The abbreviation in whose formula a place of the text lies, if it lies in one."""
        here, _, copied = self._seam(at)
        return None if copied else self.segment(here, at + 1)

    def segment(self, start: int, end: int) -> str:
        """What stands in the source for a part of the text that is not empty."""
        here, there, copied = self._seam(end - 1)
        behind = there + (end - here) if copied else next(seam[1] for seam in self.seams if seam[0] >= end)
        return self.source[self.origin(start) : behind]

    def _seam(self, at: int) -> tuple[int, int, bool]:
        return next(seam for seam in reversed(self.seams) if seam[0] <= at)


@dataclass(frozen=True)
class Abbreviations:
    """``formulas`` by name, nothing abbreviated left in them; the ``stress`` whose invariants are words; names ``to_come``.

    ``own`` has each formula with the names above it left in; one that is not among ``formulas`` is too long to be written out.
    ``known`` are the other names of the law: those of which all components are among these, or defined, are tensors.
    """

    formulas: Mapping[str, str] = field(default_factory=dict)
    stress: Stress | None = None
    to_come: frozenset[str] = frozenset()
    own: Mapping[str, str] = field(default_factory=dict)
    known: frozenset[str] = frozenset()

    def used_by(self, text: str) -> list[str]:
        """The definitions that a text uses, itself or by others, in order."""
        found, queue = set[str](), [text]
        while queue:
            new = {name for name in names_in(queue.pop()) if name in self.own} - found
            found |= new
            queue += [self.own[name] for name in new]
        return [name for name in self.own if name in found]

    def alone(self) -> Abbreviations:
        """The invariants without the definitions, whose names stay."""
        return replace(self, formulas={}, own={}, known=self.known.union(self.own))

    def words(self) -> frozenset[str]:
        """The invariants that may be used, whose names are taken."""
        return frozenset(INVARIANTS) if self.stress else frozenset()

    def written_out(self, text: str, fault: Callable[[str, int, str], InputError], most: int) -> WrittenOut:
        """``text`` without abbreviations, up to ``most`` characters; a wrong one raises ``fault`` (what, where, remedy)."""
        made, seams, length, behind = list[str](), [(0, 0, True)], 0, 0

        def put(part: str, at: int, copied: bool) -> None:
            nonlocal length
            seams.append((length, at, copied))
            made.append(part)
            length += len(part)

        for token in _TOKEN.finditer(text):
            if token.lastgroup != "name" or token.start() < behind:
                continue
            at = token.start()
            try:
                long, end = self._long(text, token)
            except InputError as wrong:
                raise fault(wrong.what, at, wrong.remedy) from None
            if long is not None:
                put(text[behind:at], behind, True)
                put(f"({long})", at, False)
                behind = end
                if length > most:
                    raise fault("the formula is too large with its definitions written out", at, f"at most {most} characters are read")
        put(text[behind:], behind, True)
        return WrittenOut("".join(made), text, tuple(seams))

    def _long(self, text: str, token: re.Match[str]) -> tuple[str | None, int]:
        """What the name at ``token`` stands for, if it is an abbreviation, and where it ends."""
        name, end = spelled(token[0]), token.end()
        called = text[end:].lstrip().startswith("(")
        if name in self.to_come:
            raise InputError(f"{name!r} is used before it is defined", remedy="a definition may use only the names above it")
        if name in self.own and name not in self.formulas:
            raise InputError(f"{name!r} is too large to be written out, which is done here", remedy="g alone may use it; shorten it")
        if name in self.formulas:
            if called:
                raise InputError(f"{name!r} is not a function of the language", remedy=f"write {name}*(...)")
            return self.formulas[name], end
        if name not in INVARIANTS or not (called or self.stress):
            return None, end
        if self.stress and not called and not INVARIANTS[name].indexed:
            return self.stress.written_out(name), end
        given, behind = _arguments(text, end) if called else ([], end)
        return self._invariant(name, given), behind

    def _invariant(self, word: str, given: list[str]) -> str | None:
        """``J2`` is ``J2(sigma)`` and ``principal(1)`` is ``principal(sigma, 1)``, as in print; None without a tensor or a stress."""
        indexed, stress = INVARIANTS[word].indexed, self.stress.name if self.stress else ""
        of, index = (given[:-1], "".join(given[-1:])) if indexed else (given, "")
        tensor = self._tensor(of[0] if of else stress) if len(of) <= 1 and (given or indexed) else None
        if tensor is not None and (index.isdigit() or not indexed):
            if indexed and index not in ("1", "2", "3"):
                raise InputError(f"there is no principal stress {index[:24]}", remedy="1 is the greatest, 3 the least")
            return tensor.written_out(word, int(index) if index else None)
        if self.stress is None:
            return None
        usage = f"{word}({stress}, 1)" if indexed else f"{word}({stress})"
        first = f"X_{KINDS[self.stress.kind][0]}"
        other = f"; for a sum such as {stress} - X, declare all components {first} ... of X and no other, or define them above"
        what = f"{word} takes the declared stress{' and a number' * indexed}"
        raise InputError(what, remedy=f"write {usage}: {INVARIANTS[word].meaning}{other}")

    def _tensor(self, text: str) -> Tensor | None:
        """The tensor that a formula is, linear in the names of tensors; None where it is no tensor of the stress's kind, or of any."""
        for kind in [self.stress.kind] if self.stress else KINDS:
            names = {x for x in names_in(text) if self._is_tensor(x, kind)}
            if names and _degree(text, names) == 1:
                ends = KINDS[kind]
                if text in names:
                    return Tensor(kind, tuple(self._plain(f"{text}_{end}") for end in ends))
                return Tensor(kind, tuple(f"({self._plain(_of_components(text, names, end))})" for end in ends))
        return None

    def _is_tensor(self, name: str, kind: str) -> bool:
        """Whether the stress, or the components of this kind, and of no larger one, are declared."""
        if self.stress is not None and name == self.stress.name:
            return True
        declared = {end for end in _ENDS if f"{name}_{end}" in self.known or f"{name}_{end}" in self.own}
        return declared == {*KINDS[kind]}

    def _plain(self, text: str) -> str:
        return self.written_out(text, lambda what, _, remedy: InputError(what, remedy=remedy), len(text) + _MOST_OF_A_COMPONENT).text


def _of_components(text: str, tensors: Collection[str], end: str) -> str:
    return _TOKEN.sub(lambda x: f"{x[0]}_{end}" if spelled(x[0]) in tensors else x[0], text)


def _degree(text: str, tensors: set[str]) -> int | None:
    """1 for a sum of tensors times numbers, 0 for what has no tensor in it; None for anything else."""

    def degree(node: ast.AST) -> int | None:
        match node:
            case ast.BinOp(one, ast.Add() | ast.Sub() | ast.Mult() | ast.Div() as way, two):
                ones, twos = degree(one), degree(two)
                if ones is None or twos is None:
                    return None
                if isinstance(way, ast.Add | ast.Sub):
                    return ones if ones == twos else None
                return None if ones + twos > 1 or (twos and isinstance(way, ast.Div)) else ones + twos
            case ast.UnaryOp(_, one):
                return degree(one)
            case ast.Name(name) if spelled(name) in tensors:
                return 1
        return None if any(isinstance(x, ast.Name) and spelled(x.id) in tensors for x in ast.walk(node)) else 0

    try:
        return degree(ast.parse(f"({text})", mode="eval").body)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None  # who reads the formula says what is wrong with it


NONE = Abbreviations()
