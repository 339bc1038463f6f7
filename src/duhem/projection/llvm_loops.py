"""Our own plain loops as LLVM's text: each function is written once, and numba is left with the loop around them.

Numba finds the types in a function statement by statement, compiles it with all that it calls, and again in whatever calls it: that is
most of what a first answer takes.  The texts that are compiled here need none of it.  They are functions of numbers, arrays and tuples
of these, ``for`` over a range or a tuple, ``while``, ``if``, assignments, and words that have one meaning in LLVM.  Each operation
becomes the one that numba makes of it, in the same order, so that the numbers are the same to the bit.  Indices are never negative.

A function is written once for each kinds of its arguments; the kind of a local is the widest that it is given.
"""

from __future__ import annotations

import ast
import math
import operator
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from duhem.expression.syntax import module_tree
from duhem.projection.llvm_values import Dense, NotLowered, Number, Value, constant, kinds_of, listed, made_of, returned, type_of

__all__ = ["lowered"]

_WIDTH = {"i1": 0, "i64": 1, "double": 2}


def lowered(text: str, space: Mapping[str, Any], name: str, kinds: tuple[Any, ...], own: str) -> tuple[str, str]:
    """A module in LLVM's text with the function ``name`` of ours as ``own``, and the kind of number that it returns, "void" for none.

    ``space`` says what the names are that the text does not give itself, and constants.  NotLowered for anything else than is read here.
    """
    module = _Module(text, space)
    function, result = module.function(name, kinds)
    if not (result is None or isinstance(result, str)):
        raise NotLowered(f"{name} returns more than a number")
    given = listed(_parameters(kinds))
    call, end = f"call {type_of(result)} {function}({given})", "ret void"
    if result is not None:
        call, end = f"%r = {call}", f"ret {result} %r"
    shown = f"define linkonce_odr {type_of(result)} @{own}({given}) alwaysinline {{\n  {call}\n  {end}\n}}"
    return "\n".join([*module.others.values(), *module.parts, shown]), type_of(result)


class _Module:
    """What is written of a text: functions of it for the kinds of arguments that they are called with, and names of others."""

    def __init__(self, text: str, space: Mapping[str, Any]) -> None:
        self.functions = {node.name: node for node in module_tree(text).body if isinstance(node, ast.FunctionDef)}
        self.space, self.parts, self.others = space, list[str](), dict[str, str]()
        self._made: dict[tuple[str, tuple[Any, ...]], tuple[str, Any]] = {}
        self._open: list[str] = []

    def function(self, name: str, kinds: tuple[Any, ...]) -> tuple[str, Any]:
        """The name in LLVM and the kinds of what is returned, None for nothing."""
        if (name, kinds) not in self._made:
            if name in self._open:
                raise NotLowered(f"{name} calls itself")
            self._open.append(name)
            written, own = _Function(self, self.functions[name], kinds), f"@{name}.{len(self._made)}"
            self._open.pop()
            self.parts.append(f"define internal {type_of(written.returned)} {own}({written.head}) {{\n{written.text}}}")
            self._made[name, kinds] = own, written.returned
        return self._made[name, kinds]

    def outside(self, name: str, kinds: str, writes: bool) -> str:
        """A function of numbers to a number: LLVM's, the C library's or numba's."""
        pure = "" if name.startswith("llvm.") or writes else " nounwind memory(read)"
        self.others[name] = f"declare double @{name}({kinds}){pure}"
        return f"@{name}"


_CALLED = {
    np.sqrt: "llvm.sqrt.f64", np.exp: "llvm.exp.f64", np.log: "llvm.log.f64", np.sin: "llvm.sin.f64", np.cos: "llvm.cos.f64",
    np.tan: "tan", np.sinh: "sinh", np.cosh: "cosh", np.tanh: "tanh", np.arcsin: "asin", np.arccos: "acos", np.arctan: "atan",
    np.expm1: "expm1", np.log1p: "log1p", abs: "llvm.fabs.f64", np.arctan2: "atan2",
    np.hypot: "_hypot" if sys.platform == "win32" else "hypot",
}  # fmt: skip
_BUILT_IN = {"abs": abs, "max": max, "min": min}
_ARITHMETIC: Mapping[type, str] = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul"}
_FOLDED: Mapping[type, Any] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow,
}  # fmt: skip
_CONVERTED = {("i64", "double"): "sitofp", ("i1", "double"): "uitofp", ("i1", "i64"): "zext", ("double", "i64"): "fptosi"}
_BITS: Mapping[type, str] = {ast.BitAnd: "and", ast.BitOr: "or", ast.LShift: "shl", ast.RShift: "ashr"}
_COMPARED: Mapping[type, str] = {ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge", ast.Eq: "eq", ast.NotEq: "ne"}


def _parameters(kinds: tuple[Any, ...]) -> tuple[Value, ...]:
    """The arguments as a function finds them, numbered."""
    place = count()
    return tuple([made_of(each, lambda kind: Number(kind, f"%{next(place)}")) for each in kinds])


def _ends(lines: Sequence[ast.stmt]) -> bool:
    """Whether nothing goes on after them."""
    match lines[-1]:
        case ast.Return():
            return True
        case ast.If(body=body, orelse=[_, *_] as otherwise):
            return _ends(body) and _ends(otherwise)
        case ast.While(test=ast.Constant(value=True)) as loop:
            return not any(isinstance(part, ast.Break) for part in ast.walk(loop))
    return False


class _Function:
    """One function for arguments of such kinds: written again until the kinds of its locals no longer widen."""

    def __init__(self, module: _Module, node: ast.FunctionDef, kinds: tuple[Any, ...]) -> None:
        stored = [part.id for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)]
        self.module, self.own = module, set(stored)
        self.kinds: dict[str, str] = {}
        self.returned: Any = None
        self.settled = False
        while not self.settled:
            self.settled, self.count, self.lines = True, 0, list[str]()
            self.slots: dict[str, str] = {}
            self.values: dict[str, tuple[tuple[int, ...], Value]] = {}
            self.place: tuple[int, ...] = ()
            self.loops: list[tuple[str, str]] = []
            given = _parameters(kinds)
            self.head = listed(given)
            for parameter, each in zip(node.args.args, given, strict=True):
                self._bind(parameter.arg, each)
            self._lines(node.body)
            if self.returned is not None and not _ends(node.body):
                raise NotLowered(f"{node.name} may end without a number")
            self.lines.append("  ret void" if self.returned is None else "  unreachable")
        self.text = "\n".join(["entry:", *self.slots.values(), *self.lines, ""])

    # -- lines and blocks

    def _let(self, kind: str, text: str) -> Number:
        self.count += 1
        self.lines.append(f"  %t{self.count} = {text}")
        return Number(kind, f"%t{self.count}")

    def _labels(self, count: int) -> list[str]:
        self.count += count
        return [f"b{self.count - k}" for k in range(count)]

    def _go(self, to: str, then: str) -> None:
        self.lines += [f"  br label %{to}", f"{then}:"]

    def _where(self, test: Number, yes: str, no: str, then: str) -> None:
        self.lines += [f"  br i1 {test}, label %{yes}, label %{no}", f"{then}:"]

    def _slot(self, name: str, kind: str) -> str:
        """Where a local is, which LLVM puts into registers."""
        self.slots[name] = f"  %{name} = alloca {kind}"
        return f"%{name}"

    def _widened(self, name: str, kind: str) -> str:
        """The kind of a local that is given such a number, too."""
        known = self.kinds.setdefault(name, kind)
        if kind != known and _WIDTH[kind] > _WIDTH[known]:
            self.kinds[name], self.settled = kind, False
        return self.kinds[name]

    def _bind(self, name: str, value: Value) -> None:
        """A local: a number has a slot; an array or a tuple, of which nothing tells at run time, is known within its block alone."""
        if isinstance(value, Number) and name not in self.values:
            kind = self._widened(name, value.kind)
            self.lines.append(f"  store {kind} {self._as(kind, value)}, ptr {self._slot(f'v.{name}', kind)}")
            return
        before, _ = self.values.get(name, (self.place, None))
        if isinstance(value, Number) or f"v.{name}" in self.slots or (before != self.place and before == self.place[: len(before)]):
            raise NotLowered(f"{name} is given two things")
        self.values[name] = self.place, value

    def _as(self, kind: str, value: Value) -> Number:
        if not isinstance(value, Number):
            raise NotLowered(kind)
        if value.kind == kind:
            return value
        if value.known is not None and kind != "i1":
            return Number(kind, known=float(value.known) if kind == "double" else int(value.known))
        if kind == "i1":
            return self._compared(value, ast.NotEq(), Number("i64", known=0))
        return self._let(kind, f"{_CONVERTED[value.kind, kind]} {value.kind} {value} to {kind}")

    # -- statements

    def _run(self, lines: Sequence[ast.stmt]) -> None:
        self.count += 1
        outer, self.place = self.place, (*self.place, self.count)
        self._lines(lines)
        self.place = outer

    def _lines(self, lines: Sequence[ast.stmt]) -> None:
        for line in lines:
            self._statement(line)

    def _statement(self, line: ast.stmt) -> None:
        match line:
            case ast.Expr(value=ast.Constant()) | ast.Pass():
                pass
            case ast.Expr(value=ast.Call() as call):
                self._value(call)
            case ast.Assign(targets=targets, value=value):
                found = self._value(value)
                for target in targets:
                    self._assign(target, found)
            case ast.AugAssign(target=target, op=op, value=value) if not any(isinstance(part, ast.Call) for part in ast.walk(target)):
                read = ast.Name(target.id, ast.Load()) if isinstance(target, ast.Name) else target
                self._assign(target, self._value(ast.BinOp(read, op, value)))
            case ast.Return(value=value):
                self._return(None if value is None else self._value(value))
            case ast.If(test=test, body=body, orelse=otherwise):
                yes, no, after = self._labels(3)
                self._where(self._test(test), yes, no if otherwise else after, yes)
                self._run(body)
                if otherwise:
                    self._go(after, no)
                    self._run(otherwise)
                self._go(after, after)
            case ast.While(test=test, body=body, orelse=[]):
                again, inside, after = self._labels(3)
                self._go(again, again)
                self._where(self._test(test), inside, after, inside)
                self._loop(body, again, after)
                self._go(again, after)
            case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Name(id="range"), args=ends), body=body, orelse=[]):
                self._for(name, [self._as("i64", self._value(end)) for end in ends], body)
            case ast.For(target=ast.Name(id=name), iter=over, body=body, orelse=[]) if isinstance(found := self._value(over), tuple):
                for each in found:
                    next_, after = self._labels(2)
                    self._bind(name, each)
                    self._loop(body, next_, "")
                    self._go(next_, next_)
            case ast.Break() | ast.Continue() if self.loops and (to := self.loops[-1][isinstance(line, ast.Break)]):
                self._go(to, *self._labels(1))
            case _:
                raise NotLowered(ast.unparse(line))

    def _loop(self, body: Sequence[ast.stmt], again: str, after: str) -> None:
        self.loops.append((again, after))
        self._run(body)
        self.loops.pop()

    def _for(self, name: str, ends: list[Number], body: Sequence[ast.stmt]) -> None:
        start, stop = ends[:2] if len(ends) > 1 else (Number("i64", known=0), ends[0])
        step = ends[2].known if len(ends) > 2 else 1
        if not step:
            raise NotLowered("a step that is not known")
        test, inside, again, after = self._labels(4)
        count = self._slot(f"n.{test}", "i64")
        self.lines.append(f"  store i64 {start}, ptr {count}")
        self._go(test, test)
        turn = self._let("i64", f"load i64, ptr {count}")
        self._where(self._let("i1", f"icmp {'slt' if step > 0 else 'sgt'} i64 {turn}, {stop}"), inside, after, inside)
        self._bind(name, turn)
        self._loop(body, again, after)
        self._go(again, again)
        self.lines.append(f"  store i64 {self._let('i64', f'add nsw i64 {turn}, {step}')}, ptr {count}")
        self._go(test, after)

    def _assign(self, target: ast.expr, value: Value) -> None:
        match target:
            case ast.Name(id=name):
                self._bind(name, value)
            case ast.Tuple(elts=targets) if isinstance(value, tuple) and len(value) == len(targets):
                for each, own in zip(targets, value, strict=True):
                    self._assign(each, own)
            case ast.Subscript(value=array, slice=place):
                rows = self._value(array)
                if not isinstance(rows, Dense):
                    raise NotLowered(ast.unparse(target))
                pointer, kind = self._address(rows, place), "double" if rows.element == "double" else "i64"
                number = self._as(kind, value)
                if rows.element not in ("double", "i64"):
                    number = self._let(rows.element, f"trunc i64 {number} to {rows.element}")
                self.lines.append(f"  store {rows.element} {number}, ptr {pointer}")
            case _:
                raise NotLowered(ast.unparse(target))

    def _return(self, value: Value | None) -> None:
        if value is None:
            self.lines.append("  ret void")
        else:
            given = returned(value)
            kinds = [self._widened(f"return.{k}", each.kind) for k, each in enumerate(given)]
            each_kind = iter(kinds)
            self.returned = kinds_of(made_of(kinds_of(value), lambda _: Number(next(each_kind))))
            whole, kind = Number("", "undef"), type_of(self.returned)
            for k, (own, each) in enumerate(zip(kinds, given, strict=True)):
                each = self._as(own, each)
                whole = each if isinstance(value, Number) else self._let(kind, f"insertvalue {kind} {whole}, {own} {each}, {k}")
            self.lines.append(f"  ret {kind} {whole}")
        self.lines.append(f"{self._labels(1)[0]}:")

    # -- expressions

    def _number(self, node: ast.expr) -> Number:
        if not isinstance(found := self._value(node), Number):
            raise NotLowered(ast.unparse(node))
        return found

    def _test(self, node: ast.expr) -> Number:
        return self._as("i1", self._number(node))

    def _value(self, node: ast.expr) -> Value:
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                return constant(value)
            case ast.Name(id=name) if name in self.values:
                place, known = self.values[name]
                if place != self.place[: len(place)]:
                    raise NotLowered(f"{name} is given elsewhere")
                return known
            case ast.Name(id=name) if f"v.{name}" in self.slots:
                return self._let(self.kinds[name], f"load {self.kinds[name]}, ptr %v.{name}")
            case ast.Name(id=name) if name not in self.own:
                return constant(self.module.space.get(name))
            case ast.Attribute(value=ast.Name(id="np"), attr="inf" | "nan" as name):
                return constant(getattr(math, name))
            case ast.Attribute(value=array, attr="shape"):
                return self._rows(array).sizes
            case ast.Tuple(elts=parts):
                return tuple([self._value(part) for part in parts])
            case ast.UnaryOp(op=ast.Not(), operand=x):
                return self._let("i1", f"xor i1 {self._test(x)}, true")
            case ast.UnaryOp(op=ast.USub(), operand=x):
                number = self._number(x)
                if number.known is not None:
                    return constant(-number.known)
                return self._let("double", f"fneg double {number}") if number.kind == "double" else self._negative(number)
            case ast.BinOp(left=a, op=op, right=b):
                return self._operation(self._value(a), op, self._value(b), node)
            case ast.BoolOp(op=op, values=values):
                return self._both(isinstance(op, ast.And), [partial(self._test, each) for each in values])
            case ast.Compare(left=left, ops=ops, comparators=others):
                ends = [self._number(left)]

                def compared(op: ast.cmpop, other: ast.expr) -> Number:
                    ends.append(self._number(other))
                    return self._compared(ends[-2], op, ends[-1])

                return self._both(True, [partial(compared, *each) for each in zip(ops, others, strict=True)])
            case ast.IfExp(test=test, body=body, orelse=otherwise):
                return self._either(self._test(test), body, otherwise)
            case ast.Subscript(value=whole, slice=place):
                return self._part(self._value(whole), place, node)
            case ast.Call():
                return self._call(node)
        raise NotLowered(ast.unparse(node))

    def _negative(self, number: Number) -> Number:
        return self._numbered(Number("i64", known=0), ast.Sub(), number)

    def _rows(self, node: ast.expr) -> Dense:
        if not isinstance(found := self._value(node), Dense):
            raise NotLowered(ast.unparse(node))
        return found

    def _part(self, whole: Value, place: ast.expr, node: ast.expr) -> Value:
        if isinstance(whole, tuple):
            at = self._number(place)
            if at.known is None or not 0 <= at.known < len(whole):
                raise NotLowered(ast.unparse(node))
            return whole[at.known]
        if isinstance(whole, Number):
            raise NotLowered(ast.unparse(node))
        if isinstance(place, ast.Slice):
            if place.lower is None or place.upper is not None or place.step is not None or whole.order != "C":
                raise NotLowered(ast.unparse(node))
            first = self._number(place.lower)
            left = self._numbered(whole.sizes[0], ast.Sub(), first)
            start = first
            for size in whole.sizes[1:]:
                start = self._numbered(start, ast.Mult(), size)
            pointer = self._let("ptr", f"getelementptr {whole.element}, ptr {whole.start}, i64 {start}")
            return Dense(whole.element, pointer, (left, *whole.sizes[1:]), local=whole.local)
        found = self._let(whole.element, f"load {whole.element}, ptr {self._address(whole, place)}")
        return found if whole.element in ("double", "i64") else self._let("i64", f"sext {whole.element} {found} to i64")

    def _address(self, rows: Dense, place: ast.expr) -> Number:
        places = [self._as("i64", self._number(each)) for each in (place.elts if isinstance(place, ast.Tuple) else [place])]
        if len(places) != len(rows.sizes) or any(each.known is not None and each.known < 0 for each in places):
            raise NotLowered("an index")
        pairs = list(zip(places, rows.sizes, strict=True))
        (at, _), *others = pairs if rows.order == "C" else pairs[::-1]
        for each, size in others:
            at = self._numbered(self._numbered(at, ast.Mult(), size), ast.Add(), each)
        return self._let("ptr", f"getelementptr {rows.element}, ptr {rows.start}, i64 {at}")

    def _numbered(self, a: Number, op: ast.operator, b: Number) -> Number:
        found = self._operation(a, op, b, None)
        assert isinstance(found, Number)
        return found

    def _operation(self, a: Value, op: ast.operator, b: Value, node: ast.expr | None) -> Value:
        if isinstance(a, tuple) and isinstance(b, tuple) and isinstance(op, ast.Add):
            return a + b
        if not (isinstance(a, Number) and isinstance(b, Number)):
            raise NotLowered(ast.unparse(node) if node else "")
        if a.known is not None and b.known is not None and type(op) in _FOLDED and not (isinstance(op, ast.Div) and not b.known):
            return constant(_FOLDED[type(op)](a.known, b.known))
        kind = "i1" if a.kind == b.kind == "i1" else "double" if "double" in (a.kind, b.kind) else "i64"
        if type(op) in _BITS and kind != "double":
            return self._let(kind, f"{_BITS[type(op)]} {kind} {self._as(kind, a)}, {self._as(kind, b)}")
        kind = "i64" if kind == "i1" else kind
        match op:
            case ast.Add() | ast.Sub() | ast.Mult():
                word = f"f{_ARITHMETIC[type(op)]} double" if kind == "double" else f"{_ARITHMETIC[type(op)]} nsw i64"
                return self._let(kind, f"{word} {self._as(kind, a)}, {self._as(kind, b)}")
            case ast.Div():
                return self._let("double", f"fdiv double {self._as('double', a)}, {self._as('double', b)}")
            case ast.Mod() if kind == "i64" and b.known and b.known > 0:  # Python's, which is never negative
                rest = self._let(kind, f"srem i64 {self._as(kind, a)}, {b}")
                return self._let(kind, f"srem i64 {self._let(kind, f'add nsw i64 {rest}, {b}')}, {b}")
            case ast.Pow() if kind == "double" and b.kind == "double":
                return self._outside("llvm.pow.f64", [a, b])
        raise NotLowered(ast.unparse(node) if node else "")

    def _compared(self, a: Number, op: ast.cmpop, b: Number) -> Number:
        word = _COMPARED.get(type(op))
        if word is None:
            raise NotLowered("a comparison")
        if "double" in (a.kind, b.kind):
            word = "une" if word == "ne" else f"o{word}"
            return self._let("i1", f"fcmp {word} double {self._as('double', a)}, {self._as('double', b)}")
        word = word if word in ("eq", "ne") else f"s{word}"
        return self._let("i1", f"icmp {word} i64 {self._as('i64', a)}, {self._as('i64', b)}")

    def _both(self, conjunction: bool, tests: Sequence[Callable[[], Number]]) -> Number:
        """``and`` and ``or``: what comes after is only worked out where it decides."""
        if len(tests) == 1:
            return tests[0]()
        room, after = self._slot(f"s.{self.count}", "i1"), *self._labels(1)
        for k, each in enumerate(tests):
            test = each()
            self.lines.append(f"  store i1 {test}, ptr {room}")
            if k < len(tests) - 1:
                (next_,) = self._labels(1)
                self._where(test, *((next_, after) if conjunction else (after, next_)), next_)
        self._go(after, after)
        return self._let("i1", f"load i1, ptr {room}")

    def _either(self, test: Number, body: ast.expr, otherwise: ast.expr) -> Value:
        yes, no, after = self._labels(3)
        name = f"c.{body.lineno}.{body.col_offset}"
        self._where(test, yes, no, yes)
        a = self._number(body)
        kind = self._widened(name, a.kind)
        self.lines.append(f"  store {kind} {self._as(kind, a)}, ptr {self._slot(name, kind)}")
        self._go(after, no)
        b = self._number(otherwise)
        kind = self._widened(name, b.kind)
        self.lines.append(f"  store {kind} {self._as(kind, b)}, ptr %{name}")
        self._go(after, after)
        return self._let(kind, f"load {kind}, ptr %{name}")

    # -- calls

    def _call(self, node: ast.Call) -> Value:
        match node:
            case ast.Call(func=ast.Name(id=name), args=args) if name in self.module.functions:
                return self._own(name, [self._value(each) for each in args])
            case ast.Call(func=ast.Attribute(value=ast.Call(args=[x]), attr="view"), args=[ast.Attribute(attr=kind)]):
                target = "double" if kind == "float64" else "i64"
                given = self._as("i64" if target == "double" else "double", self._number(x))
                return self._let(target, f"bitcast {given.kind} {given} to {target}")
            case ast.Call(func=ast.Attribute(value=ast.Name(id="np"), attr="empty"), args=[shape, *kind]):
                sizes = self._value(shape)
                sizes = sizes if isinstance(sizes, tuple) else (sizes,)
                if kind or not all(isinstance(size, Number) and size.known for size in sizes):
                    raise NotLowered(ast.unparse(node))
                (name,) = self._labels(1)
                pointer = self._slot(f"r.{name}", f"[{math.prod(size.known for size in sizes)} x double], align 8")
                return Dense("double", Number("ptr", pointer), sizes, local=True)
            case ast.Call(func=ast.Name(id="len"), args=[x]) if isinstance(whole := self._value(x), tuple):
                return constant(len(whole))
            case ast.Call(func=ast.Name(id="float" | "int" as name), args=[x]):
                return self._as("double" if name == "float" else "i64", self._number(x))
            case ast.Call(func=ast.Name(id=name), args=args):
                return self._word(self.module.space.get(name, _BUILT_IN.get(name)), [self._number(each) for each in args])
        raise NotLowered(ast.unparse(node))

    def _own(self, name: str, arguments: Sequence[Value]) -> Value:
        own, result = self.module.function(name, tuple(map(kinds_of, arguments)))
        call = f"call {type_of(result)} {own}({listed(tuple(arguments))})"
        if result is None:
            self.lines.append(f"  {call}")
            return ()
        whole = self._let(type_of(result), call)
        if isinstance(result, str):
            return whole
        place = count()
        return made_of(result, lambda kind: self._let(kind, f"extractvalue {whole.kind} {whole}, {next(place)}"))

    def _outside(self, name: str, arguments: Sequence[Number], writes: bool = False) -> Number:
        given = [each if each.kind in ("ptr", "i32") else self._as("double", each) for each in arguments]
        own = self.module.outside(name, ", ".join(each.kind for each in given), writes)
        return self._let("double", f"call double {own}({listed(tuple(given))})")

    def _word(self, word: Any, numbers: list[Number]) -> Value:
        if word in (max, min):
            found = numbers[0]
            for other in numbers[1:]:
                test = self._compared(other, ast.Gt() if word is max else ast.Lt(), found)
                kind = "double" if "double" in (found.kind, other.kind) else "i64"
                found = self._let(kind, f"select i1 {test}, {kind} {self._as(kind, other)}, {kind} {self._as(kind, found)}")
            return found
        if word is abs and numbers[0].kind == "i64":
            return self._word(max, [numbers[0], self._negative(numbers[0])])
        if word in _CALLED:
            return self._outside(_CALLED[word], numbers)
        if word is math.frexp:
            room = self._slot("exponent", "i32")
            share = self._outside("numba_frexp", [numbers[0], Number("ptr", room)], writes=True)
            return share, self._let("i64", f"sext i32 {self._let('i32', f'load i32, ptr {room}')} to i64")
        if word is math.ldexp:
            return self._outside("numba_ldexp", [numbers[0], self._let("i32", f"trunc i64 {self._as('i64', numbers[1])} to i32")])
        if word is math.floor:
            return self._as("i64", self._outside("floor", numbers))
        a = self._as("double", numbers[0])
        if word in (math.isfinite, np.isfinite):
            nothing = self._let("double", f"fsub double {a}, {a}")
            return self._let("i1", f"fcmp ord double {nothing}, {nothing}")
        if word is np.isnan:
            return self._let("i1", f"fcmp uno double {a}, {a}")
        if word in (np.maximum, np.minimum):  # one that is nan, the first of two, else the one
            b = self._as("double", numbers[1])
            own, any_ = self._let("i1", f"fcmp uno double {a}, {a}"), self._let("i1", f"fcmp uno double {a}, {b}")
            first = self._let("i1", f"fcmp {'oge' if word is np.maximum else 'ole'} double {a}, {b}")
            test = self._let("i1", f"select i1 {any_}, i1 {own}, i1 {first}")
            return self._let("double", f"select i1 {test}, double {a}, double {b}")
        raise NotLowered(str(word))
