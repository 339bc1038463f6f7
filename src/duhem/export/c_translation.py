"""Plain loops over small arrays, from Python into C99: what a compiler makes of a law's increment is written once.

Read is the Python that :mod:`duhem.projection.newton_kernel` is written in: functions of numbers and arrays, ``for`` over a range,
``while``, ``if``, assignments, floats, ints and bools; names in capitals are constants.  Each operation becomes the one of C that
rounds as Python's does, in the same order; a quotient by zero is infinite or nan, as it is for numba.  Anything else is refused.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from duhem.expression.elementary import ELEMENTARY
from duhem.expression.syntax import module_tree

__all__ = ["Array", "NotTranslated", "c_functions"]

# -- expressions --------------------------------------------------------------------------------------------------------

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


# -- functions ----------------------------------------------------------------------------------------------------------

_OWN = {  # what C has no function for that treats nan as Python does
    "larger": "static double larger(double a, double b) { return b > a ? b : a; }",
    "smaller": "static double smaller(double a, double b) { return b < a ? b : a; }",
    "binary_exponent": "static int binary_exponent(double x) { int e; (void)frexp(x, &e); return e; }",
}


def c_functions(
    text: str, entry: str, arrays: Mapping[str, Array], plain: Mapping[str, str], given: Mapping[str, str] | None = None
) -> str:
    """The C of the function ``entry`` of the Python ``text``, of those that it calls and of their constants.

    ``arrays`` says what each array is by name, ``plain`` the types (``int``, ``float``, ``bool``) of other parameters that have no
    annotation: a name means one thing in all functions.  ``given``: C in the place of functions that look at the bits of a number.
    Every function is static.
    """
    module = module_tree(text)
    bodies = {node.name: node for node in module.body if isinstance(node, ast.FunctionDef)}
    wanted = _reached(entry, bodies)
    constants = dict(_constants(module))
    types = {name: TYPES[_returned(bodies[name])] for name in wanted}
    instead = given or {}
    functions = {name: _Function(bodies[name], types, arrays, plain, constants) for name in wanted if name not in instead}
    made = [instead[name] if name in instead else functions[name].text() for name in wanted]
    used = {name for function in functions.values() for name in function.names}
    used |= {name for array in arrays.values() for name in _capitals(array.sizes)}
    own = [text for name, text in _OWN.items() if any(f"{name}(" in function for function in made)]
    return "\n\n".join(filter(None, [_definitions(constants, used), "\n".join(own), *made]))


def _reached(entry: str, bodies: Mapping[str, ast.FunctionDef]) -> list[str]:
    """The functions that ``entry`` needs, each after those it calls."""
    found: list[str] = []

    def visit(name: str) -> None:
        for node in ast.walk(bodies[name]):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in bodies and node.func.id not in found:
                if node.func.id == name:
                    raise NotTranslated(f"{name} calls itself")
                visit(node.func.id)
        if name not in found:
            found.append(name)

    visit(entry)
    return found


def _returned(function: ast.FunctionDef) -> str:
    """The type of what is returned; of a generated function without annotations: a number if anything."""
    if function.returns is not None:
        return ast.unparse(function.returns)
    return "float" if any(isinstance(node, ast.Return) and node.value is not None for node in ast.walk(function)) else "None"


def _constants(module: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    for node in module.body:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                pairs = _pairs(target, node.value) if isinstance(target, ast.Tuple) else [(target, node.value)]
                yield from ((one.id, value) for one, value in pairs if isinstance(one, ast.Name))


def _pairs(target: ast.expr, value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    if not isinstance(target, ast.Tuple):
        return [(target, value)]
    if not isinstance(value, ast.Tuple) or len(value.elts) != len(target.elts):
        raise NotTranslated(f"{ast.unparse(target)} = {ast.unparse(value)}")
    return list(zip(target.elts, value.elts, strict=True))


def _capitals(texts: Sequence[str]) -> set[str]:
    return {node.id for text in texts for node in ast.walk(module_tree(text)) if isinstance(node, ast.Name)}


def _definitions(constants: Mapping[str, ast.expr], used: set[str]) -> str:
    """The constants that are used: whole numbers by an enum, for the sizes of arrays, others by their text."""
    whole = [
        f"{name} = {v.value}" for name, v in constants.items() if name in used and isinstance(v, ast.Constant) and type(v.value) is int
    ]
    others = [
        f"#define {name} ({Expression({}, {}, {}).of(value, CHOICE)})"
        for name, value in constants.items()
        if name in used and not (isinstance(value, ast.Constant) and type(value.value) is int)
    ]
    lines = [f"enum {{ {', '.join(whole[i : i + 8])} }};" for i in range(0, len(whole), 8)]
    return "\n".join([*lines, *others])


class _Function(Expression):
    """One function as C: its locals found out from what they are given."""

    def __init__(
        self,
        node: ast.FunctionDef,
        functions: Mapping[str, str],
        arrays: Mapping[str, Array],
        plain: Mapping[str, str],
        constants: Mapping[str, ast.expr],
    ) -> None:
        super().__init__(functions, dict(arrays), {})
        self.node, self.known = node, set(constants)
        self.body = _live(node.body)
        self.local: dict[str, Array] = {}
        self.head = ", ".join(self._parameter(p, plain) for p in node.args.args)
        self.parameters = {p.arg for p in node.args.args}
        for name, value in constants.items():
            self.kinds[name] = self.kind(value)
        self._find_kinds()
        self.names = {n.id for s in self.body for n in ast.walk(s) if isinstance(n, ast.Name)}

    def _parameter(self, parameter: ast.arg, plain: Mapping[str, str]) -> str:
        own = self.arrays.get(f"{self.node.name}.{parameter.arg}") or self.arrays.get(parameter.arg)
        said = "Any" if parameter.annotation is None else ast.unparse(parameter.annotation)
        if own is not None and said == "Any":
            self.arrays = {**self.arrays, parameter.arg: own}
            return own.passed(named(parameter.arg))
        said = plain.get(parameter.arg, said) if said == "Any" else said
        if said not in TYPES:
            raise NotTranslated(f"{self.node.name}: what is {parameter.arg}?")
        self.kinds[parameter.arg] = TYPES[said]
        return f"{TYPES[said]} {named(parameter.arg)}"

    def _assignments(self) -> Iterator[tuple[str, ast.expr]]:
        for statement in self.body:
            for node in ast.walk(statement):
                if isinstance(node, ast.Assign):
                    for target, value in _pairs(node.targets[0], node.value):
                        if isinstance(target, ast.Name):
                            yield target.id, value
                elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                    yield node.target.id, node.value

    def _find_kinds(self) -> None:
        """The types of the locals: a double where any of the values is one; until nothing changes."""
        for name, value in self._assignments():
            if (made := self._made(value)) is not None:
                self.local[name] = made
                self.arrays = {**self.arrays, name: made}
        self.variables: dict[str, int] = {}
        for name, _ in self._assignments():
            if name not in self.local:
                self.variables[name] = self.variables.get(name, 0) + 1
        settled = False
        while not settled:
            settled = True
            for name, value in self._assignments():
                if name not in self.local and self.kinds.get(name) != "double" and self.kinds.get(name) != (kind := self.kind(value)):
                    self.kinds[name], settled = kind, False

    def _made(self, value: ast.expr) -> Array | None:
        """np.empty(sizes), np.empty(sizes, np.int8)."""
        if not (isinstance(value, ast.Call) and isinstance(value.func, ast.Attribute) and value.func.attr == "empty"):
            return None
        sizes = value.args[0].elts if isinstance(value.args[0], ast.Tuple) else [value.args[0]]
        return Array("signed char" if len(value.args) > 1 else "double", tuple(self.of(size) for size in sizes))

    def text(self) -> str:
        """The whole function, with its docstring as a comment."""
        said = ast.get_docstring(self.node)
        declared = [f"    {array.declared(named(name))};" for name, array in self.local.items()]
        self.single = {n for s in self.body for n in _targets(s) if self.variables.get(n) == 1 and n not in self.parameters}
        for kind in ("double", "int"):
            names = [named(n) for n in self.variables if self.kinds[n] == kind and n not in self.single | self.parameters]
            declared += [f"    {kind} {', '.join(names)};"] * bool(names)
        loaded = {n.id for s in self.body for n in ast.walk(s) if isinstance(n, ast.Name)}
        unused = [f"    (void){named(p.arg)};" for p in self.node.args.args if p.arg not in loaded]
        lines = [*declared, *unused, *self._block(self.body, 1, True)]
        comment = [f"/* {' '.join(said.replace('`', '').replace('*/', '* /').replace('/*', '/ *').split())} */"] if said else []
        return "\n".join([*comment, f"static {self.functions[self.node.name]} {self.node.name}({self.head})", "{", *lines, "}"])

    def _block(self, body: Sequence[ast.stmt], depth: int, top: bool = False) -> Iterator[str]:
        pad = "    " * depth
        for statement in body:
            match statement:
                case ast.Expr(value=ast.Constant()) | ast.Pass() | ast.Return(value=None):
                    if isinstance(statement, ast.Return):
                        yield f"{pad}return;"
                case ast.Expr(value=ast.Call() as call):
                    void = isinstance(call.func, ast.Name) and self.functions.get(call.func.id) == "void"
                    yield f"{pad}{'' if void else '(void)'}{self.of(call, PREFIX)};"
                case ast.Assign(targets=[target], value=value):
                    yield from (f"{pad}{line}" for line in self._assigned(_pairs(target, value), top))
                case ast.AugAssign(target=target, op=op, value=value) if type(op) in OPERATORS:
                    yield f"{pad}{self.of(target)} {OPERATORS[type(op)][0]}= {self.of(value)};"
                case ast.Return(value=ast.expr() as value):
                    yield f"{pad}return {self.of(value)};"
                case ast.Break():
                    yield f"{pad}break;"
                case ast.Continue():
                    yield f"{pad}continue;"
                case ast.If(test=test, body=inner, orelse=otherwise):
                    yield f"{pad}if ({self.of(test)}) {{"
                    yield from self._block(inner, depth + 1)
                    if otherwise:
                        yield f"{pad}}} else {{"
                        yield from self._block(otherwise, depth + 1)
                    yield f"{pad}}}"
                case ast.While(test=test, body=inner, orelse=[]):
                    yield f"{pad}while ({self.of(test)}) {{"
                    yield from self._block(inner, depth + 1)
                    yield f"{pad}}}"
                case ast.For(orelse=[]):
                    yield f"{pad}for ({self._range(statement)}) {{"
                    yield from self._block(statement.body, depth + 1)
                    yield f"{pad}}}"
                case _:
                    raise NotTranslated(ast.unparse(statement))

    def _range(self, loop: ast.For) -> str:
        """The head of a loop over a range, whose ends the loop leaves alone."""
        match loop.iter:
            case ast.Call(func=ast.Name(id="range"), args=[ast.expr() as end]):
                start, step = ast.Constant(0), "++"
            case ast.Call(func=ast.Name(id="range"), args=[start, end]):
                step = "++"
            case ast.Call(func=ast.Name(id="range"), args=[start, end, ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=1))]):
                step = "--"
            case _:
                raise NotTranslated(ast.unparse(loop.iter))
        ends = {n.id for n in ast.walk(loop.iter) if isinstance(n, ast.Name)}
        if not isinstance(loop.target, ast.Name) or ends & {n for s in loop.body for n in _written(s)} or loop.target.id in self.variables:
            raise NotTranslated(ast.unparse(loop).splitlines()[0])
        i = named(loop.target.id)
        return f"int {i} = {self.of(start)}; {i} {'<' if step == '++' else '>'} {self.of(end, 5)}; {i}{step}"

    def _assigned(self, pairs: Sequence[tuple[ast.expr, ast.expr]], top: bool) -> Iterator[str]:
        """Values first where one is needed after it is written over."""
        pairs = [(target, value) for target, value in pairs if not (isinstance(target, ast.Name) and target.id in self.local)]
        written = [ast.dump(target).replace("Store", "Load") for target, _ in pairs]
        late = any(w in ast.dump(value) for i, w in enumerate(written) for _, value in pairs[i + 1 :])
        if late:
            yield "{"
            for k, (_, value) in enumerate(pairs):
                yield f"    const {self.kind(value)} value_{k} = {self.of(value)};"
        for k, (target, value) in enumerate(pairs):
            new = top and isinstance(target, ast.Name) and target.id in self.single
            head = f"const {self.kinds[target.id]} " if new and isinstance(target, ast.Name) else "    " * late
            yield f"{head}{self.of(target)} = {f'value_{k}' if late else self.of(value)};"
        if late:
            yield "}"


def _targets(statement: ast.stmt) -> list[str]:
    """The names that one statement gives a value to."""
    if not isinstance(statement, ast.Assign):
        return []
    return [target.id for target, _ in _pairs(statement.targets[0], statement.value) if isinstance(target, ast.Name)]


def _written(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id


def _live(body: list[ast.stmt]) -> list[ast.stmt]:
    """Without what is computed for nobody, of lines that only give names to expressions: generated text has such."""
    while True:
        read = {n.id for s in body for n in ast.walk(s) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
        kept = [s for s in body if not (isinstance(s, ast.Assign) and isinstance(s.targets[0], ast.Name) and s.targets[0].id not in read)]
        if len(kept) == len(body):
            return kept
        body = kept
