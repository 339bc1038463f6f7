"""A network in an ONNX file as a criterion file.  An ONNX file is data: nothing in it is executed."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from duhem.errors import InputError, MissingExtraError
from duhem.expression.abbreviations import Stress
from duhem.law.learned import Book, LearnedFile, read_from
from duhem.law.network import REMEDY, GraphNode, Network, criterion_file

__all__ = ["onnx_network"]

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
        return criterion_file(_network(model.graph), Book({}, stem, forces), name, level)


def _check_meaning(model: Any, newest: int) -> None:
    """InputError where an operator may be another than what is read here: in another version, or by a function of the file."""
    versions = [each.version for each in model.opset_import if each.domain in _STANDARD]
    if odd := [x for x in versions if not _OLDEST <= x <= newest]:
        what = f"the file has operators of version {odd[0]}, and those of versions {_OLDEST} to {newest} are read"
        raise InputError(what, remedy="export the network again for such an opset")
    if own := [each.name for each in model.functions if each.domain in _STANDARD]:
        raise InputError(f"the file has a function of its own for the operator {own[0][:_SAID]}", remedy=REMEDY)


def _network(graph: Any) -> Network:
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
