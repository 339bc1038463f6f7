"""A network in an ONNX file as a criterion file: each node is a formula of what goes into it.

An ONNX file is data: nothing in it is executed.  The operators that are read are those as which linear layers and their activations are
exported; in none of them do the rows of a batch meet.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError, MissingExtraError
from duhem.expression.abbreviations import Stress
from duhem.law.learned import Book, LearnedFile, check_numbers

__all__ = ["onnx_network"]

Array = NDArray[Any]
_WORDS = {"Relu": "pos", "Softplus": "softplus", "Tanh": "tanh"}
_PLAIN = (("transA", 0), ("alpha", 1.0), ("beta", 1.0))  # of Gemm, x w + b
_SIGNS = {"Add": "+", "Sub": "-", "Mul": "*", "Div": "/"}
_OPERATORS = ("Gemm", "MatMul", *_SIGNS, *_WORDS, "Concat", "Transpose", "Identity", "Constant")
_STANDARD = ("", "ai.onnx")
_OLDEST = 7  # before, vectors are joined by other rules
_MOST_PARTS = 10_000  # of joined vectors
_SAID = 60  # letters of a name that a message repeats
_REMEDY = "export the layers alone, with constants folded, for a batch of shape (1, n); or save the weights with numpy.savez"


def onnx_network(file: str | os.PathLike[str], name: str, *, forces: Sequence[str] | Stress, level: str = "0", stem: str) -> LearnedFile:
    """The criterion file of the network in an ONNX file: K is where its output is at most ``level``.

    The last axis of its one input has the ``forces``, and its one output has one part.  InputError for anything else, with the node and
    its operator; MissingExtraError without the package onnx.
    """
    try:
        import onnx
    except ImportError:
        raise MissingExtraError("onnx", "learned") from None
    where = os.fspath(file)
    try:
        model = onnx.load(where)
        onnx.checker.check_model(model)
        _check_meaning(model, onnx.defs.onnx_opset_version())
        return _Reader(Book({}, stem, forces), Counter(x for node in model.graph.node for x in node.input)).file(model.graph, name, level)
    except InputError as fault:
        raise InputError(fault.what, where=fault.where or where, remedy=fault.remedy) from None
    except FileNotFoundError:
        raise InputError("there is no such file", where=where, remedy="check the path") from None
    except Exception as fault:  # protobuf, onnx and NumPy have errors of their own for what a file should not contain
        said = " ".join(str(fault).split())[:120]
        raise InputError(f"the file cannot be read: {said}", where=where, remedy="export the network again") from None


def _check_meaning(model: Any, newest: int) -> None:
    """InputError where an operator may be another than what is read here: in another version, or by a function of the file."""
    versions = [each.version for each in model.opset_import if each.domain in _STANDARD]
    if odd := [x for x in versions if not _OLDEST <= x <= newest]:
        what = f"the file has operators of version {odd[0]}, and those of versions {_OLDEST} to {newest} are read"
        raise InputError(what, remedy="export the network again for such an opset")
    if own := [each.name for each in model.functions if each.domain in _STANDARD]:
        raise InputError(f"the file has a function of its own for the operator {own[0][:_SAID]}", remedy=_REMEDY)


@dataclass(frozen=True)
class _Vector:
    """What depends on the input: ``formula`` is its part i, of ``width``; ``rank`` is 2 where it is a row of a batch, else 1."""

    formula: str
    width: int
    rank: int

    def part(self, i: str) -> str:
        return re.sub(r"\[i\b", f"[{i}", self.formula)


@dataclass
class _Reader:
    """What is found of each value of the graph, and the definitions of those that others take parts of."""

    book: Book
    uses: Counter[str]
    found: dict[str, Array | _Vector] = field(default_factory=dict)
    rows: list[str] = field(default_factory=list)

    def file(self, graph: Any, name: str, level: str) -> LearnedFile:
        from onnx import numpy_helper

        self.found = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
        inputs = [each for each in graph.input if each.name not in self.found]
        if len(inputs) != 1 or len(graph.output) != 1:
            what = f"the network has {len(inputs)} inputs and {len(graph.output)} outputs"
            raise InputError(what, remedy="export one function of the stress")
        shape = [axis.dim_value for axis in inputs[0].type.tensor_type.shape.dim]
        if len(shape) not in (1, 2) or shape[-1] not in (0, len(self.book.components)):
            what = f"the input has the shape {shape}, with 0 where it is free, and {len(self.book.components)} forces are named"
            raise InputError(what, remedy="name each part of the last axis")
        self.found[inputs[0].name] = _Vector("x[i]", len(self.book.components), len(shape))
        for node in graph.node:
            made = self.value(node)
            many = self.uses[node.output[0]] > 1  # so that no formula stands in two places
            self.found[node.output[0]] = self.named(made) if many and isinstance(made, _Vector) else made
        last = self.found.get(graph.output[0].name)
        if not isinstance(last, _Vector) or last.width != 1:
            raise InputError(f"the output {graph.output[0].name} is no single number that depends on the input", remedy=_REMEDY)
        return self.book.criterion_file(name, self.rows, last.part("1"), level)

    def value(self, node: Any) -> Array | _Vector:
        """What a node makes of what was found before it."""
        from onnx import helper, numpy_helper

        given = {each.name: helper.get_attribute_value(each) for each in node.attribute}
        if node.domain not in _STANDARD or node.op_type not in _OPERATORS:
            raise InputError(f"{_told(node)} is not read", remedy=f"operators that are read: {', '.join(_OPERATORS)}; {_REMEDY}")
        parts = [self.found[each] for each in node.input if each]
        match node.op_type, parts:
            case "Constant", [] if "value" in given:
                return numpy_helper.to_array(given["value"])
            case "Identity", [x]:
                return x
            case "Transpose", [np.ndarray() as x]:
                return np.transpose(x, given.get("perm"))
            case "Relu", [np.ndarray() as x]:  # weights that are kept >= 0
                return np.maximum(x, 0)
            case "MatMul", [_Vector() as x, np.ndarray() as w] if w.ndim == 2:
                return self.linear(x, w.T, node.input[1])
            case "MatMul", [np.ndarray() as w, _Vector(rank=1) as x] if w.ndim == 2:
                return self.linear(x, w, node.input[0])
            case "Gemm", [_Vector(rank=2) as x, np.ndarray() as w, *bias] if w.ndim == 2 and [given.get(x, y) for x, y in _PLAIN] == [
                y for _, y in _PLAIN
            ]:
                made = self.linear(x, w if given.get("transB") else w.T, node.input[1])
                return self.joined("+", made, self.vector(bias[0], 2, node), node) if bias else made
            case (("Relu" | "Softplus" | "Tanh"), [_Vector() as x]):
                return _Vector(f"{_WORDS[node.op_type]}({x.formula})", x.width, x.rank)
            case (("Add" | "Sub" | "Mul" | "Div"), [a, b]) if isinstance(a, _Vector) or isinstance(b, _Vector):
                rank = max(x.rank for x in (a, b) if isinstance(x, _Vector))
                return self.joined(_SIGNS[node.op_type], self.vector(a, rank, node), self.vector(b, rank, node), node)
            case "Concat", [_Vector(rank=rank), *_] if given["axis"] in (-1, rank - 1):
                ends = [self.named(x) for x in parts if isinstance(x, _Vector) and x.rank == rank]
                if len(ends) == len(parts) and sum(x.width for x in ends) <= _MOST_PARTS:
                    texts = [f'"{x.part(str(i))}"' for x in ends for i in range(1, x.width + 1)]
                    return self.defined(f"[{', '.join(texts)}]", len(texts), rank)
        raise InputError(f"{_told(node)} stands between values of kinds or shapes that are not read", remedy=_REMEDY)

    def linear(self, x: _Vector, w: Array, said: str) -> _Vector:
        """w x, by the rows of w."""
        if w.shape[1] != x.width:
            raise InputError(f"{said} has {w.shape[1]} numbers for each output", remedy=f"it takes {x.width}")
        name = self.named(x).formula.removesuffix("[i]")
        return _Vector(f"sum(j, 1, {x.width}, {self.table('W', w, said)}[i, j]*{name}[j])", len(w), x.rank)

    def joined(self, sign: str, a: _Vector, b: _Vector, node: Any) -> _Vector:
        """Part by part; what has one part has it for each part of the other."""
        width = max(a.width, b.width)
        if a.rank != b.rank or not {a.width, b.width} <= {1, width}:
            raise InputError(f"{_told(node)} joins vectors with {a.width} and {b.width} parts", remedy=_REMEDY)
        left, right = (x.part("1") if x.width < width else x.formula for x in (a, b))
        return _Vector(f"{left} + {right}" if sign == "+" else f"({left}) {sign} ({right})", width, a.rank)

    def vector(self, x: Array | _Vector, rank: int, node: Any) -> _Vector:
        """A value as it is, or numbers that are the same for all rows of a batch."""
        if isinstance(x, _Vector):
            return x
        if x.ndim > rank or x.size != (x.shape or (1,))[-1]:
            raise InputError(f"{_told(node)} takes numbers of the shape {x.shape}", remedy="give one for each part, the same for all rows")
        return _Vector(f"{self.table('b', x.reshape(-1, 1), _told(node))}[i, 1]", x.size, rank)

    def table(self, letter: str, array: Array, said: str) -> str:
        """The name of a table of numbers."""
        check_numbers(said, array)
        name = f"{letter}{sum(each.startswith(letter) for each in self.book.files)}"
        self.book.left[name] = array
        self.book.table(name, *array.shape)
        return name

    def named(self, x: _Vector) -> _Vector:
        """The vector as one of which parts can be taken by an index."""
        if re.fullmatch(r"\w+\[i\]", x.formula):
            return x
        return self.defined(f'"vector(i, 1, {x.width}, {x.formula})"', x.width, x.rank)

    def defined(self, text: str, width: int, rank: int) -> _Vector:
        name = f"z{len(self.rows)}"
        self.rows.append(f"{name} = {text}")
        return _Vector(f"{name}[i]", width, rank)


def _told(node: Any) -> str:
    """A node for a message."""
    operator, name = (f"{node.domain}." if node.domain else "") + node.op_type, node.name or node.output[0]
    return f"the operator {operator[:_SAID]} ({'node' if node.name else 'of'} {name[:_SAID]})"
