"""A network as a graph of operators, as a criterion file: each node is a formula of what goes into it.

The operators are those of ONNX, as linear layers and their activations are exported; in none of those that are read do the rows of a
batch meet.  What depends on weights alone is a number: it is computed in double precision and rounded to the precision of the weights.

Files of ``torch.export.save`` and ONNX files are read, and nothing in a file is executed.  That of PyTorch, which is read without PyTorch,
is an archive: the graph as JSON, and each weight as the bytes of its numbers.  It may hold
pickles and compiled code too, which PyTorch runs when it loads the file; they are never opened here.  Each operator of PyTorch becomes
operators of ONNX.  An ONNX file is data alone.
"""

from __future__ import annotations

import json
import os
import re
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError, imported_from
from duhem.expression.abbreviations import Stress
from duhem.law.learned import MOST_NUMBERS, Book, LearnedFile, check_numbers, exact, read_from

__all__ = ["REMEDY", "SWITCH", "GraphNode", "Network", "criterion_file", "not_read", "onnx_network", "pt2_network"]

Array = NDArray[Any]
_WORDS = {
    "Relu": "pos({x})", "Softplus": "softplus({x})", "Tanh": "tanh({x})", "Sigmoid": "1/2 + tanh(({x})/2)/2", "Exp": "exp({x})",
    "Log": "log({x})", "Sqrt": "sqrt({x})", "Abs": "abs({x})", "Neg": "-({x})", "LeakyRelu": "max({x}, {a}*({x}))",
    "Elu": "pos({x}) + {a}*(exp(-neg({x})) - 1)", "Celu": "pos({x}) + {a}*(exp(-neg({x})/{a}) - 1)",
}  # fmt: skip
_PAIRS = {
    "Add": "{x} + {y}", "Sub": "({x}) - ({y})", "Mul": "({x}) * ({y})", "Div": "({x}) / ({y})", "Max": "max({x}, {y})",
    "Min": "min({x}, {y})",
}  # fmt: skip
_OVER_ALL = {
    "ReduceSum": "sum(j, 1, {n}, {x})", "ReduceMean": "sum(j, 1, {n}, {x})/{n}", "ReduceMax": "max_over(j, 1, {n}, {x})",
    "ReduceL2": "sqrt(sum(j, 1, {n}, ({x})**2))", "ReduceLogSumExp": "log(sum(j, 1, {n}, exp({x})))",
}  # fmt: skip
_OF_NUMBERS: Mapping[str, Callable[..., Any]] = {
    "Relu": lambda x: np.maximum(x, 0.0), "Softplus": lambda x: np.logaddexp(0.0, x), "Sigmoid": lambda x: 1.0 / (1.0 + np.exp(-x)),
    "Tanh": np.tanh, "Exp": np.exp, "Log": np.log, "Sqrt": np.sqrt, "Abs": np.abs, "Neg": np.negative, "Add": np.add, "Sub": np.subtract,
    "Mul": np.multiply, "Div": np.divide, "Max": np.maximum, "Min": np.minimum, "Pow": np.power,
}  # fmt: skip
_OPERATORS = (
    "Gemm", "MatMul", *_WORDS, *_PAIRS, *_OVER_ALL, "Pow", "Clip", "Where", "Greater", "Concat", "Gather", "Slice", "Transpose", "Squeeze",
    "Unsqueeze", "Reshape", "Cast", "Identity", "Dropout", "Constant",
)  # fmt: skip
_PLAIN = (("transA", 0), ("alpha", 1.0), ("beta", 1.0))  # of Gemm, x w + b; MatMul with b, of a vector too, is PyTorch's linear
_SLOPES = {"LeakyRelu": 0.01, "Elu": 1.0, "Celu": 1.0}  # alpha, where a node does not say it
_FLOATS = {1: "f4", 10: "f2", 11: "f8"}  # by their numbers in ONNX
SWITCH = 20.0  # where log(1 + exp x) is x within 2.1e-9, less than float32 tells apart
_MOST_PARTS = 10_000  # of joined vectors
_SAID = 60  # letters of a name that a message repeats
REMEDY = "export the layers alone, with constants folded, for a batch of shape (1, n); or save the weights with numpy.savez"


@dataclass(frozen=True)
class GraphNode:
    """``output`` is what ``operator`` makes of ``inputs``: names, numbers, or None for one that is left out; ``given`` are attributes."""

    operator: str
    inputs: Sequence[Any]
    output: str
    given: Mapping[str, Any] = field(default_factory=dict)
    name: str = ""

    def __str__(self) -> str:
        return f"the operator {self.operator[:_SAID]} ({'node' if self.name else 'of'} {(self.name or self.output)[:_SAID]})"


@dataclass(frozen=True)
class Network:
    """Nodes in an order in which they can be computed; ``inputs`` have shapes with 0 where an axis is free."""

    nodes: Sequence[GraphNode]
    weights: Mapping[str, Array]
    inputs: Mapping[str, Sequence[int]]
    outputs: Sequence[str]


def criterion_file(network: Network, book: Book, name: str, level: str) -> LearnedFile:
    """The criterion file of the network: K is where its output is at most ``level``.

    The last axis of its one input has the forces of the book, and its one output has one part.  InputError for anything else, with the
    node and its operator.
    """
    if len(network.inputs) != 1 or len(network.outputs) != 1:
        what = f"the network has {len(network.inputs)} inputs and {len(network.outputs)} outputs"
        raise InputError(what, remedy="export one function of the stress")
    ((start, shape),) = network.inputs.items()
    if len(shape) not in (1, 2) or shape[-1] not in (0, len(book.components)):
        what = f"the input has the shape {list(shape)}, with 0 where it is free, and {len(book.components)} forces are named"
        raise InputError(what, remedy="name each part of the last axis")
    uses = Counter(each for node in network.nodes for each in node.inputs if isinstance(each, str))
    first = _Vector("x[i]", len(book.components), len(shape))
    reader = _Reader(book, len(shape), {**network.weights, start: first}, {each.output: each for each in network.nodes})
    for node in network.nodes:
        made = reader.value(node)
        many = uses[node.output] > 1  # so that no formula stands in two places
        reader.found[node.output] = reader.named(made) if many and isinstance(made, _Vector) else made
    last = reader.found.get(network.outputs[0])
    if not isinstance(last, _Vector) or last.width != 1:
        raise InputError(f"the output {network.outputs[0]} is no single number that depends on the input", remedy=REMEDY)
    return book.criterion_file(name, reader.rows, last.part("1"), level)


def not_read(node: GraphNode) -> InputError:
    return InputError(f"{node} is not read", remedy=f"operators that are read: {', '.join(_OPERATORS)}; {REMEDY}")


@dataclass(frozen=True)
class _Vector:
    """What depends on the input: ``formula`` is its part i, of ``width``; ``rank`` is 2 in a row of a batch, else 1; 0 without axis."""

    formula: str
    width: int
    rank: int

    def part(self, i: str) -> str:
        return re.sub(r"\[i\b", f"[{i}", self.formula)


@dataclass(frozen=True)
class _Switch:
    """Where the value ``over`` is greater than ``at``."""

    over: Any
    at: float


_Value = Array | _Vector | _Switch


@dataclass
class _Reader:
    """What is ``found`` of each value of the graph, and the definitions of those that others take parts of."""

    book: Book
    rank: int  # of the input
    found: dict[str, _Value]
    nodes: Mapping[str, GraphNode]  # by output
    rows: dict[str, str | Sequence[str]] = field(default_factory=dict)

    def value(self, node: GraphNode) -> _Value:
        """What a node makes of what was found before it."""
        if node.operator not in _OPERATORS:
            raise not_read(node)
        parts = [self.found[each] if isinstance(each, str) else each for each in node.inputs]
        moved = any(isinstance(x, _Vector) for x in parts)
        made = parts[0] if node.operator == "Identity" else self.moved(node, parts) if moved else self.number(node, parts)
        if made is None:
            raise InputError(f"{node} stands between values of kinds or shapes that are not read", remedy=REMEDY)
        return made

    def number(self, node: GraphNode, parts: Sequence[Any]) -> Array | None:
        """Of numbers, a number."""
        given, axes = node.given, _axes(node, parts)
        match node.operator, parts:
            case "Constant", [] if "value" in given:
                return np.asarray(given["value"])
            case "Transpose", [np.ndarray() as x]:
                return np.transpose(x, given.get("perm"))
            case "Cast", [np.ndarray() as x] if given["to"] in _FLOATS:
                return x.astype(_FLOATS[given["to"]])
            case "Unsqueeze", [np.ndarray() as x, *_] if axes:
                return np.expand_dims(x, tuple(axes))
            case "Clip", [np.ndarray() as x, *_] if ends := _ends(node, parts):
                return np.clip(x, *(None if end is None else x.dtype.type(end) for end in ends))
            case "ReduceL2", [np.ndarray() as x, *_] if axes:
                return _rounded(np.sqrt((x.astype(float) ** 2).sum(tuple(axes), keepdims=bool(given.get("keepdims", 1)))), [x])
            case operator, [np.ndarray(), *_] if operator in _OF_NUMBERS and {x.dtype.kind for x in parts} == {"f"}:
                if np.prod(np.broadcast_shapes(*(x.shape for x in parts)), dtype=float) <= MOST_NUMBERS:
                    with np.errstate(all="ignore"):  # what is not finite is refused as a table
                        return _rounded(_OF_NUMBERS[operator](*(x.astype(float) for x in parts)), parts)
        return None

    def moved(self, node: GraphNode, parts: Sequence[Any]) -> _Vector | _Switch | None:
        """Of what depends on the input, a vector."""
        given, operator = node.given, node.operator
        plain = all(given.get(key, y) == y for key, y in _PLAIN)
        match operator, parts:
            case "Dropout", [_Vector() as x, *more] if len(more) < 2 or (isinstance(more[1], np.ndarray) and not more[1].any()):
                return x
            case "Cast", [_Vector() as x] if given["to"] in (1, 11):
                return x
            case "MatMul", [np.ndarray() as w, _Vector(rank=1) as x] if w.ndim == 2:
                return self.linear(x, w, node.inputs[0])
            case "MatMul" | "Gemm", [_Vector() as x, np.ndarray() as w, *bias] if plain and w.ndim == 2 and x.rank > (operator == "Gemm"):
                made = self.linear(x, w if given.get("transB") else w.T, node.inputs[1])
                return self.joined(_PAIRS["Add"], made, self.vector(bias[0], x.rank, node), node) if bias and bias[0] is not None else made
            case _, [_Vector() as x] if operator in _WORDS:
                slope = float(given.get("alpha", _SLOPES.get(operator, 0.0)))
                if (operator == "LeakyRelu" and not 0.0 <= slope <= 1.0) or (operator == "Celu" and slope <= 0.0):
                    return None
                twice = _WORDS[operator].count("{x}") > 1
                x = self.named(x) if twice else x
                made = _Vector(_WORDS[operator].format(x=x.formula, a=exact(np.float64(slope))), x.width, x.rank)
                return self.named(made) if twice else made
            case "Clip", [_Vector() as x, *_] if ends := _ends(node, parts):
                low, high = (None if end is None else exact(np.float64(end)) for end in ends)
                formula = x.formula if low is None else f"max({x.formula}, {low})"
                return _Vector(formula if high is None else f"min({formula}, {high})", x.width, x.rank)
            case "Pow", [_Vector() as x, np.ndarray() as power] if power.size == 1:
                return _Vector(f"({x.formula})**({Fraction(float(power.reshape(-1)[0]))})", x.width, x.rank)
            case _, [a, b] if operator in _PAIRS:
                rank = max(x.rank for x in (a, b) if isinstance(x, _Vector))
                return self.joined(_PAIRS[operator], self.vector(a, rank, node), self.vector(b, rank, node), node)
            case "Greater", [_Vector(), np.ndarray() as at] if at.size == 1:
                return _Switch(node.inputs[0], _single(at))
            case "Where", [_Switch() as switch, _Vector(), _Vector() as soft] if self.is_softplus(switch, *node.inputs[1:]):
                return soft
        return self.shaped(node, parts)

    def shaped(self, node: GraphNode, parts: Sequence[Any]) -> _Vector | None:
        """Parts taken out, joined or summed, and axes of one part put in or out."""
        given, axes = node.given, _axes(node, parts)
        match node.operator, parts:
            case "Concat", [_Vector(rank=rank), *_] if rank and given["axis"] in (-1, rank - 1):
                ends = [self.named(x) for x in parts if isinstance(x, _Vector) and x.rank == rank]
                if len(ends) == len(parts) and sum(x.width for x in ends) <= _MOST_PARTS:
                    texts = [x.part(str(i)) for x in ends for i in range(1, x.width + 1)]
                    return self.defined(texts, len(texts), rank)
            case "Gather", [_Vector() as x, np.ndarray(ndim=0 | 1) as at] if x.rank and given.get("axis", 0) in (-1, x.rank - 1):
                return self.some(x, np.arange(x.width)[at])
            case "Slice", [_Vector() as x, *ends] if x.rank and 2 < len(ends) < 5:
                begin, stop, axis, step = (int(_single(each)) for each in (*ends, np.ones(1, int))[:4])
                if axis in (-1, x.rank - 1) and step > 0:
                    return self.some(x, np.arange(x.width)[begin:stop:step])
                return x if (begin, axis, step) == (0, 0, 1) and stop >= 2**31 - 1 else None  # all rows of a batch
            case "Squeeze", [_Vector(width=1) as x, *_] if x.rank and (axes is None or axes in ([-1], [x.rank - 1])):
                return _Vector(x.part("1"), 1, 0)
            case "Reshape", [_Vector(width=1) as x, np.ndarray() as shape] if shape.tolist() == [-1]:
                return _Vector(x.part("1"), 1, 0)
            case "Unsqueeze", [_Vector(rank=0) as x, *_] if axes in ([-1], [self.rank - 1]):
                return _Vector(x.formula, 1, self.rank)
            case _, [_Vector() as x, *_] if node.operator in _OVER_ALL and x.rank and axes in ([-1], [x.rank - 1]):
                part = re.sub(r"\[i\b", "[j", self.named(x).formula)
                return _Vector(_OVER_ALL[node.operator].format(n=x.width, x=part), 1, x.rank if given.get("keepdims", 1) else 0)
        return None

    def is_softplus(self, switch: _Switch, plain: Any, soft: Any) -> bool:
        """Whether a choice is x where b x > 20 or more, else log(1 + exp(b x))/b: softplus as PyTorch computes it."""
        made = self.nodes.get(soft)
        if made is not None and made.operator == "Div":
            scaled = self.nodes.get(switch.over)
            if scaled is None or scaled.operator != "Mul" or scaled.inputs[0] != plain:
                return False
            factor, divisor = (_single(self.found.get(each.inputs[1])) for each in (scaled, made))
            if not factor == divisor > 0.0:
                return False
            made, plain = self.nodes.get(made.inputs[0]), switch.over
        return made is not None and made.operator == "Softplus" and made.inputs[0] == switch.over == plain and switch.at >= SWITCH

    def linear(self, x: _Vector, w: Array, said: Any) -> _Vector:
        """w x, by the rows of w."""
        if w.shape[1] != x.width:
            raise InputError(f"{said} has {w.shape[1]} numbers for each output", remedy=f"it takes {x.width}")
        name = self.named(x).formula.removesuffix("[i]")
        return _Vector(f"sum(j, 1, {x.width}, {self.table('W', w, said)}[i, j]*{name}[j])", len(w), x.rank)

    def joined(self, form: str, a: _Vector, b: _Vector, node: GraphNode) -> _Vector:
        """Part by part; what has one part has it for each part of the other."""
        width = max(a.width, b.width)
        if a.rank != b.rank or not {a.width, b.width} <= {1, width}:
            raise InputError(f"{node} joins vectors with {a.width} and {b.width} parts", remedy=REMEDY)
        left, right = (x.part("1") if x.width < width else x.formula for x in (a, b))
        return _Vector(form.format(x=left, y=right), width, a.rank)

    def vector(self, x: Array | _Vector, rank: int, node: GraphNode) -> _Vector:
        """A value as it is, or numbers that are the same for all rows of a batch."""
        if isinstance(x, _Vector):
            return x
        if x.ndim > max(rank, 1) or x.size != (x.shape or (1,))[-1] or (not rank and x.size != 1):
            raise InputError(f"{node} takes numbers of the shape {x.shape}", remedy="give one for each part, the same for all rows")
        return _Vector(f"{self.table('b', x.reshape(-1, 1), node)}[i, 1]", x.size, rank)

    def table(self, letter: str, array: Array, said: object) -> str:
        """The name of a table of numbers."""
        check_numbers(f"{said}", array)
        name = f"{letter}{sum(each.startswith(letter) for each in self.book.files)}"
        self.book.left[name] = array
        self.book.table(name, *array.shape)
        return name

    def some(self, x: _Vector, at: Array) -> _Vector | None:
        """Parts of a vector; a single number where ``at`` is one."""
        texts = [self.named(x).part(str(i + 1)) for i in at.reshape(-1)]
        return None if not texts else self.defined(texts, len(texts), x.rank) if at.ndim else _Vector(texts[0], 1, 0)

    def named(self, x: _Vector) -> _Vector:
        """The vector as one of which parts can be taken by an index."""
        if re.fullmatch(r"\w+\[i\]", x.formula):
            return x
        return self.defined(f"vector(i, 1, {x.width}, {x.formula})", x.width, x.rank)

    def defined(self, text: str | Sequence[str], width: int, rank: int) -> _Vector:
        name = f"z{len(self.rows)}"
        self.rows[name] = text
        return _Vector(f"{name}[i]", width, rank)


def _axes(node: GraphNode, parts: Sequence[Any]) -> list[int] | None:
    """The axes of a node, which older operators have as an attribute and newer ones as an input."""
    given = node.given.get("axes", parts[1] if len(parts) == 2 else None)
    return None if given is None or isinstance(given, _Vector) else [int(x) for x in np.ravel(given)]


def _ends(node: GraphNode, parts: Sequence[Any]) -> list[float | None] | None:
    """The least and the greatest that a node lets through; None where one is no single number."""
    ends = [node.given.get(name, end) for name, end in zip(("min", "max"), [*parts[1:], None, None], strict=False)]
    found = [None if end is None else _single(np.asarray(end)) for end in ends]
    return None if any(x is not None and np.isnan(x) for x in found) else found


def _single(x: Any) -> float:
    return float(x.reshape(-1)[0]) if isinstance(x, np.ndarray) and x.size == 1 and x.dtype.kind in "fi" else np.nan


def _rounded(x: Any, of: Sequence[Array]) -> Array:
    return np.asarray(x).astype(np.result_type(*([y for y in of if y.ndim] or of)))


# -- files of torch.export.save ----------------------------------------------------------------------------------------

_MOST_BYTES = 50_000_000  # of the graph
_SCHEMA = 8  # of the graph, since PyTorch 2.5
_TYPES = {5: "i8", 6: "f2", 7: "f4", 8: "f8"}  # by their numbers in PyTorch
_ORDERS = {b"little": "<", b"big": ">"}
_TO_ONNX = {6: 10, 7: 1, 8: 11}
_FOLDERS = {"parameter": "weights", "buffer": "weights", "tensor_constant": "constants"}
_AGAIN = "save it with torch.export.save of a newer PyTorch, such as 2.13, or export it with torch.onnx.export"
_END = 2**63 - 1
_OF_ALL = {
    "sum": "ReduceSum", "mean": "ReduceMean", "amax": "ReduceMax", "logsumexp": "ReduceLogSumExp", "linalg_vector_norm": "ReduceL2",
    "linalg_norm": "ReduceL2",
}  # fmt: skip
_SIMPLE: Mapping[str, tuple[str, ...]] = {  # the operator of ONNX and the arguments that it takes, where it is the same
    **{word: (word.capitalize(), "self") for word in ("relu", "tanh", "sigmoid", "exp", "log", "sqrt", "abs", "neg")},
    **{word: (word.capitalize(), "self", "other") for word in ("add", "sub", "mul", "div")},
    "rsub": ("Sub", "other", "self"), "square": ("Mul", "self", "self"), "pow": ("Pow", "self", "exponent"),
    "maximum": ("Max", "self", "other"), "minimum": ("Min", "self", "other"), "matmul": ("MatMul", "self", "other"),
    "mm": ("MatMul", "self", "mat2"), "clamp": ("Clip", "self", "min", "max"), "clamp_min": ("Clip", "self", "min"),
    **{word: ("Identity", "self") for word in ("detach", "detach_", "alias", "clone", "contiguous", "lift_fresh_copy")},
}  # fmt: skip
_ARGUMENTS: Mapping[str, Callable[[Any], Any]] = {
    "as_tensor": lambda x: str(x["name"]), "as_tensors": lambda x: [str(each["name"]) for each in x], "as_float": float,
    **dict.fromkeys(("as_int", "as_bool", "as_ints", "as_scalar_type"), lambda x: x),
    **dict.fromkeys(("as_none", "as_device", "as_layout", "as_memory_format"), lambda _: None),
}  # fmt: skip


def pt2_network(file: str | os.PathLike[str], name: str, *, forces: Sequence[str] | Stress, level: str = "0", stem: str) -> LearnedFile:
    """The criterion file of the network in a ``.pt2`` file: K is where its output is at most ``level``.

    The last axis of its one input has the ``forces``, and its one output has one part.  InputError for anything else, with the node and
    its operator, and for weights that are pickled.
    """
    with read_from(file, _AGAIN), zipfile.ZipFile(file) as archive:
        return criterion_file(_network(_Archive(archive)), Book({}, stem, forces), name, level)


class _Archive:
    """The entries of a file, of which only JSON and numbers are read."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self.archive = archive
        found = [each for each in archive.namelist() if each.endswith("/models/model.json")]
        if len(found) != 1:
            raise InputError("the file has no graph that can be read without running what is in it", remedy=_AGAIN)
        self.root = found[0].removesuffix("models/model.json")

    def bytes(self, name: str, most: int) -> bytes:
        with self.archive.open(self.root + name) as stream:
            read = stream.read(most + 1)
        if len(read) > most:
            raise InputError(f"{name} is larger than {most} bytes", remedy="import a smaller network")
        return read

    def tree(self, name: str) -> Any:
        return json.loads(self.bytes(name, _MOST_BYTES))

    def array(self, folder: str, of: Mapping[str, Any], name: str) -> Array:
        """A weight, whose entries are found in its bytes by its strides."""
        told, meta = of.get(name), (of.get(name) or {}).get("tensor_meta")
        if not told or told["use_pickle"] or not meta or meta["dtype"] not in _TYPES:
            raise InputError(f"{name} is not kept as plain numbers", remedy="save weights of dense tensors of floats")
        sizes, strides, offset = ([x["as_int"] for x in each] for each in (meta["sizes"], meta["strides"], [meta["storage_offset"]]))
        if prod(sizes) > MOST_NUMBERS or min([*sizes, *strides, *offset]) < 0 or len(sizes) != len(strides):
            raise InputError(f"{name} has the sizes {sizes}", remedy=f"at most {MOST_NUMBERS} numbers can be read")
        kind = np.dtype(_ORDERS[self.bytes("byteorder", 10)] + _TYPES[meta["dtype"]])
        flat = np.frombuffer(self.bytes(f"data/{folder}/{told['path_name']}", 8 * MOST_NUMBERS), kind)
        steps = (np.arange(n).reshape([-1] + [1] * (len(sizes) - k - 1)) * by for k, (n, by) in enumerate(zip(sizes, strides, strict=True)))
        return np.asarray(flat[sum(steps, np.asarray(offset[0]))], kind.newbyteorder("="))  # an array too where it has no axis


def _network(archive: _Archive) -> Network:
    model = archive.tree("models/model.json")
    if model["schema_version"]["major"] != _SCHEMA:
        raise InputError(f"the graph is of version {model['schema_version']['major']}, and {_SCHEMA} is read", remedy=_AGAIN)
    module = model["graph_module"]
    graph, signature = module["graph"], module["signature"]
    configs = {each: archive.tree(f"data/{each}/model_{each}_config.json")["config"] for each in ("weights", "constants")}
    weights, inputs = dict[str, Array](), dict[str, list[int]]()
    for spec in signature["input_specs"]:
        ((kind, told),) = spec.items()
        if kind == "user_input" and "as_tensor" in told["arg"]:
            name = told["arg"]["as_tensor"]["name"]
            inputs[name] = [x.get("as_int", 0) for x in graph["tensor_values"][name]["sizes"]]
        elif kind in _FOLDERS:
            folder = "constants" if told.get("persistent") is False else _FOLDERS[kind]
            weights[told["arg"]["name"]] = archive.array(folder, configs[folder], told[f"{kind}_name"])
        else:
            raise InputError(f"the network takes a {kind} that is no tensor of floats", remedy="export one function of the stress")
    outputs = [each["user_output"]["arg"]["as_tensor"]["name"] for each in signature["output_specs"]]
    nodes = [each for told in graph["nodes"] for each in _nodes(told)]
    return Network(nodes, weights, inputs, outputs)


def _nodes(told: Mapping[str, Any]) -> Iterator[GraphNode]:
    """What a node of PyTorch is in operators of ONNX."""
    target, name = told["target"].removeprefix("torch.ops.aten."), told.get("name") or ""
    if target == "_assert_tensor_metadata.default":
        return
    word, out = target.partition(".")[0], told["outputs"][0]["as_tensor"]["name"]
    given = {each["name"]: x for each in told["inputs"] if (x := _argument(each["arg"])) is not None}
    asked, x = given.get, given.get("self", given.get("input"))

    def node(operator: str, *inputs: Any, into: str = out, **attributes: Any) -> GraphNode:
        return GraphNode(operator, [x if x is None or isinstance(x, str) else np.asarray(x) for x in inputs], into, attributes, name)

    match word:
        case _ if word in _SIMPLE and asked("alpha", 1) == 1 and asked("rounding_mode") is None:
            operator, *names = _SIMPLE[word]
            yield node(operator, *(float(x) if isinstance(x, int) else x for x in map(asked, names)))
        case "linear":
            yield node("MatMul", x, given["weight"], asked("bias"), transB=1)
        case "addmm" if asked("alpha", 1) == asked("beta", 1) == 1:
            yield node("Gemm", given["mat1"], given["mat2"], x)
        case "softplus" if asked("threshold", 20.0) >= SWITCH and (beta := float(asked("beta", 1.0))) > 0.0:
            yield node("Mul", x, beta, into=f"{out}.x")
            yield node("Softplus", x if beta == 1.0 else f"{out}.x", into=out if beta == 1.0 else f"{out}.y")
            if beta != 1.0:
                yield node("Div", f"{out}.y", beta)
        case "silu":
            yield node("Sigmoid", x, into=f"{out}.x")
            yield node("Mul", x, f"{out}.x")
        case "elu" | "celu" if asked("scale", 1) == asked("input_scale", 1) == 1:
            yield node(word.capitalize(), x, alpha=asked("alpha", 1.0))
        case "leaky_relu":
            yield node("LeakyRelu", x, alpha=asked("negative_slope", 0.01))
        case "hardtanh":
            yield node("Clip", x, min=asked("min_val", -1.0), max=asked("max_val", 1.0))
        case "cat":
            yield node("Concat", *given["tensors"], axis=asked("dim", 0))
        case "stack":
            ends = [f"{out}.{k}" for k, _ in enumerate(given["tensors"])]
            yield from (node("Unsqueeze", x, into=end, axes=[asked("dim", 0)]) for x, end in zip(given["tensors"], ends, strict=True))
            yield node("Concat", *ends, axis=asked("dim", 0))
        case "t" | "numpy_T" | "transpose" | "permute":
            yield node("Transpose", x, perm=asked("dims", [1, 0]))
        case "squeeze" | "unsqueeze":
            yield node(word.capitalize(), x, **({} if asked("dim") is None else {"axes": np.ravel(given["dim"]).tolist()}))
        case "view" | "reshape":
            yield node("Reshape", x, asked("size", asked("shape")))
        case _ if word in _OF_ALL and asked("dim") and asked("ord", 2) == 2 and not asked("dtype"):
            yield node(_OF_ALL[word], x, axes=given["dim"], keepdims=int(asked("keepdim", False)))
        case "select":
            yield node("Gather", x, given["index"], axis=given["dim"])
        case "slice":
            yield node("Slice", x, *([asked(key, other)] for key, other in (("start", 0), ("end", _END), ("dim", 0), ("step", 1))))
        case "to" | "_to_copy" if asked("dtype") in _TO_ONNX:
            yield node("Cast", x, to=_TO_ONNX[given["dtype"]])
        case "_weight_norm":  # v g/|v|, by rows or columns
            yield node("ReduceL2", given["v"], into=f"{out}.s", axes=[1 - asked("dim", 0)], keepdims=1)
            yield node("Div", given["g"], f"{out}.s", into=f"{out}.q")
            yield node("Mul", given["v"], f"{out}.q")
        case "dropout" if not given["train"]:
            yield node("Identity", x)
        case _:
            raise not_read(GraphNode(told["target"], [], out))


def _argument(arg: Mapping[str, Any]) -> Any:
    """A number, a list of them, or the name of a value; None for what says where a value is kept."""
    ((kind, value),) = arg.items()
    if kind not in _ARGUMENTS:
        raise InputError(f"an operator takes {kind.removeprefix('as_')}", remedy="export the layers alone")
    return _ARGUMENTS[kind](value)


# -- ONNX files --------------------------------------------------------------------------------------------------------


_STANDARD = ("", "ai.onnx")
_OLDEST = 7  # before, vectors are joined by other rules


def onnx_network(file: str | os.PathLike[str], name: str, *, forces: Sequence[str] | Stress, level: str = "0", stem: str) -> LearnedFile:
    """The criterion file of the network in an ONNX file: K is where its output is at most ``level``.

    The last axis of its one input has the ``forces``, and its one output has one part.  InputError for anything else, with the node and
    its operator; MissingExtraError without the package onnx.
    """
    with imported_from("onnx", "learned"):
        import onnx
    with read_from(file, "export the network again"):
        model = onnx.load(os.fspath(file))
        onnx.checker.check_model(model)
        _check_meaning(model, onnx.defs.onnx_opset_version())
        return criterion_file(_onnx_graph(model.graph), Book({}, stem, forces), name, level)


def _check_meaning(model: Any, newest: int) -> None:
    """InputError where an operator may be another than what is read here: in another version, or by a function of the file."""
    versions = [each.version for each in model.opset_import if each.domain in _STANDARD]
    if odd := [x for x in versions if not _OLDEST <= x <= newest]:
        what = f"the file has operators of version {odd[0]}, and those of versions {_OLDEST} to {newest} are read"
        raise InputError(what, remedy="export the network again for such an opset")
    if own := [each.name for each in model.functions if each.domain in _STANDARD]:
        raise InputError(f"the file has a function of its own for the operator {own[0][:_SAID]}", remedy=REMEDY)


def _onnx_graph(graph: Any) -> Network:
    from onnx import helper, numpy_helper

    weights = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
    shapes = {each.name: [axis.dim_value for axis in each.type.tensor_type.shape.dim] for each in graph.input if each.name not in weights}
    nodes = []
    for each in graph.node:
        given = {x.name: helper.get_attribute_value(x) for x in each.attribute}
        given = {x: numpy_helper.to_array(y) if x == "value" else y for x, y in given.items()}
        operator = each.op_type if each.domain in _STANDARD else f"{each.domain}.{each.op_type}"
        nodes.append(GraphNode(operator, [x or None for x in each.input], each.output[0], given, each.name))
    return Network(nodes, weights, shapes, [each.name for each in graph.output])
