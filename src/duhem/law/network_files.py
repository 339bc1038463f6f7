"""A network in a file of ``torch.export.save`` or in an ONNX file as a criterion file; nothing in a file is executed.

That of PyTorch, which is read without PyTorch, is an archive: the graph as JSON, and each weight as the bytes of its numbers.  It may hold
pickles and compiled code too, which PyTorch runs when it loads the file; they are never opened here.  Each operator of PyTorch becomes
operators of ONNX.  An ONNX file is data alone.
"""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError, MissingExtraError
from duhem.expression.abbreviations import Stress
from duhem.law.learned import MOST_NUMBERS, Book, LearnedFile, read_from
from duhem.law.network import REMEDY, SWITCH, GraphNode, Network, criterion_file, not_read

__all__ = ["onnx_network", "pt2_network"]

Array = NDArray[Any]
_MOST_BYTES = 50_000_000  # of the graph
_SCHEMA = 8  # of the graph, since PyTorch 2.5
_TYPES = {5: "i8", 6: "f2", 7: "f4", 8: "f8"}  # by their numbers in PyTorch
_ORDERS = {b"little": "<", b"big": ">"}
_TO_ONNX = {6: 10, 7: 1, 8: 11}
_FOLDERS = {"parameter": "weights", "buffer": "weights", "tensor_constant": "constants"}
_AGAIN = "save it with torch.export.save of a newer PyTorch, such as 2.13, or export it with torch.onnx.export"
_END = 2**63 - 1
_OVER_ALL = {
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
        case _ if word in _OVER_ALL and asked("dim") and asked("ord", 2) == 2 and not asked("dtype"):
            yield node(_OVER_ALL[word], x, axes=given["dim"], keepdims=int(asked("keepdim", False)))
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
_SAID = 60  # letters of a name that a message repeats


def onnx_network(file: str | os.PathLike[str], name: str, *, forces: Sequence[str] | Stress, level: str = "0", stem: str) -> LearnedFile:
    """The criterion file of the network in an ONNX file: K is where its output is at most ``level``.

    The last axis of its one input has the ``forces``, and its one output has one part.  InputError for anything else, with the node and
    its operator; MissingExtraError without the package onnx.
    """
    try:
        import onnx
    except ImportError:
        raise MissingExtraError("onnx", "learned") from None
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
