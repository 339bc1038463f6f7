"""A network in an ONNX file is the law that it is in the exact values of its weights; the reference evaluator of onnx says what it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from duhem import load
from duhem.cli import cli
from duhem.errors import InputError
from duhem.expression import numpy_
from duhem.law.network import onnx_network
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection

onnx = pytest.importorskip("onnx")

RNG = np.random.default_rng(3)


def node(operator: str, inputs: str, output: str, **attributes: Any) -> Any:
    return onnx.helper.make_node(operator, inputs.split(), [output], **attributes)


@dataclass
class Net:
    """A graph from ``stress`` to ``out`` as an exporter writes it, with 32-bit weights unless they say otherwise."""

    nodes: Sequence[Any]
    weights: dict[str, Any] = field(default_factory=dict)
    inputs: Sequence[Any] = ("N", 3)
    output: Sequence[Any] = ("N", 1)
    more: Sequence[Any] = ()

    def write(self, folder: Path) -> Path:
        arrays = {name: np.asarray(x) for name, x in self.weights.items()}
        kept = [onnx.numpy_helper.from_array(x.astype("f4") if x.dtype == float else x, name) for name, x in arrays.items()]
        ends = [onnx.helper.make_tensor_value_info(name, 1, list(s)) for name, s in (("stress", self.inputs), ("out", self.output))]
        graph = onnx.helper.make_graph(list(self.nodes), "network", [ends[0], *self.more], [ends[1]], kept)
        made = onnx.helper.make_model(
            graph, opset_imports=[onnx.helper.make_opsetid("", 17), onnx.helper.make_opsetid("own", 1)], ir_version=9
        )
        onnx.save(made, folder / "net.onnx")
        return folder / "net.onnx"


def normal(*shape: int) -> Any:
    return RNG.normal(size=shape)


def above(*shape: int) -> Any:
    return abs(RNG.normal(size=shape)) / shape[-1]


LAYERS = {
    "A0": normal(8, 3),
    "c0": normal(8),
    "W1": above(8, 8),
    "A1": normal(8, 3),
    "c1": normal(8),
    "last": above(11, 1),
    "c2": normal(1),
}


def icnn(word: str) -> Net:
    """Linear layers of PyTorch, the stress led to the second and joined to what the last reads."""
    return Net(
        [
            node("Gemm", "stress A0 c0", "h", transB=1), node(word, "h", "z"), node("Gemm", "z W1", "u", transB=1),
            node("Gemm", "stress A1 c1", "v", transB=1), node("Add", "u v", "s"), node(word, "s", "y"),
            node("Concat", "y stress", "all", axis=-1), node("MatMul", "all last", "m"), node("Add", "m c2", "out"),
        ],
        LAYERS,
    )  # fmt: skip


KERAS = Net(
    [
        node("MatMul", "stress k0", "a"), node("Add", "a b0", "b"), node("Tanh", "b", "c"), node("MatMul", "c k1", "d"),
        node("Add", "b1 d", "out"),
    ],
    {"k0": normal(3, 6), "b0": normal(1, 6), "k1": normal(6, 1).astype("f2").astype("f4"), "b1": np.float32(0.5)},
)  # fmt: skip
EQUINOX = Net(
    [node("MatMul", "W0 stress", "a"), node("Add", "a b0", "b"), node("Softplus", "b", "c"), node("MatMul", "W1 c", "out")],
    {"W0": normal(6, 3), "b0": normal(6), "W1": normal(1, 6)},
    inputs=(3,),
    output=(1,),
)
CLAMPED = Net(
    [
        node("Relu", "raw", "kept"), node("Transpose", "kept", "turned", perm=[1, 0]), node("Identity", "stress", "same"),
        node("MatMul", "same first", "a"), node("Relu", "a", "b"), node("MatMul", "b turned", "out"),
    ],
    {"raw": normal(1, 5), "first": normal(3, 5)},
)  # fmt: skip
HALF = onnx.helper.make_tensor("half", 1, [], [0.5])
SCALED = Net(
    [
        node("Constant", "", "half", value=HALF), node("Sub", "stress mean", "a"), node("Div", "a size", "b"),
        node("Gemm", "b W bias", "c", transB=0, alpha=1.0, beta=1.0), node("Mul", "c half", "d"), node("Mul", "d d", "e"),
        node("Relu", "d", "f"), node("Concat", "e f", "g", axis=1), node("MatMul", "g last", "h"), node("Add", "h d", "i"),
        node("MatMul", "i last2", "out"),
    ],
    {
        "mean": normal(3), "size": above(3) + 1.0, "W": normal(3, 4), "bias": normal(4), "last": normal(8, 1),
        "last2": normal(4, 1),
    },
)  # fmt: skip


def imported(folder: Path, net: Net, *asked: str) -> Any:
    cli.main(["import", f"{net.write(folder)}", "--out", f"{folder / 'law.toml'}", "--stress", "plane", *asked], standalone_mode=False)
    return load(folder / "law.toml")


OTHERS = Net(
    [
        node("Softplus", "raw", "kept"), node("Div", "kept two", "halved"), node("Gemm", "stress halved bias", "a", transB=1),
        node("Mul", "a two", "b"), node("Softplus", "b", "c"), node("Div", "c two", "d"), node("Greater", "b twenty", "more"),
        node("Where", "more a d", "e"), node("ReduceMax", "e", "f", axes=[1], keepdims=1), node("Gather", "a second", "g", axis=1),
        node("Unsqueeze", "g last", "h"), node("Slice", "a from to last", "i"), node("Elu", "i", "j", alpha=0.5),
        node("Concat", "f h j", "k", axis=1), node("LeakyRelu", "k", "l", alpha=0.25), node("Pow", "l two", "m"),
        node("Clip", "m low high", "n"),
        node("ReduceSum", "n last", "o", keepdims=0), node("Sigmoid", "o", "p"), node("Celu", "p", "q", alpha=2.0), node("Neg", "q", "out"),
    ],
    {
        "raw": normal(5, 3), "bias": normal(5), "two": np.float32(2.0), "twenty": np.float32(20.0), "second": np.array(1), "last": [1],
        "from": [2], "to": [99], "low": np.float32(0.1), "high": np.float32(1.5),
    },
    output=("N",),
)  # fmt: skip


@pytest.mark.parametrize(
    "net", [icnn("Relu"), icnn("Softplus"), icnn("Tanh"), KERAS, EQUINOX, CLAMPED, SCALED, OTHERS],
    ids=["relu", "softplus", "tanh", "keras", "equinox", "clamped", "scaled", "others"],
)  # fmt: skip
def test_a_network_is_the_same_as_before(tmp_path: Path, net: Net) -> None:
    from onnx.reference import ReferenceEvaluator

    law = imported(tmp_path, net, "--level", "0.25")
    at = 2.0 * RNG.normal(size=(10_000 if len(net.inputs) == 2 else 100, 3)).astype("f4")
    run = ReferenceEvaluator(f"{tmp_path / 'net.onnx'}")
    rows = [at] if len(net.inputs) == 2 else at
    wanted = np.concatenate([np.ravel(run.run(None, {"stress": each})[0]) for each in rows])
    found = numpy_.compiled(law.g, law.force_symbols())(*at.T.astype(float))
    assert found == pytest.approx(wanted - 0.25, rel=3e-6, abs=3e-5)


@pytest.mark.parametrize("word", ["Relu", "Softplus"])
def test_an_input_convex_network_is_proved(tmp_path: Path, word: str) -> None:
    law = stated(law_as_text(imported(tmp_path, icnn(word), "--level", "4")))
    assert not objection("convexity", "composition", frozenset(), law, {})


def test_a_network_with_many_weights_is_read(tmp_path: Path) -> None:
    names = [f"h{k}" for k in range(4)]
    nodes = [node("Gemm", "stress A bias", "h0", transB=1)]
    for k in range(3):
        nodes += [node("Relu", f"h{k}", f"z{k}"), node("Gemm", f"z{k} W{k} bias" if k < 2 else f"z{k} W2", names[k + 1], transB=1)]
    weights = {"A": normal(64, 3), "bias": normal(64), "W0": above(64, 64), "W1": above(64, 64), "W2": above(1, 64)}
    net = Net([*nodes, node("Identity", "h3", "out")], weights)
    assert imported(tmp_path, net).graph is not None


def wrong(nodes: Sequence[Any], **more: Any) -> Net:
    weights = {"W": normal(3, 1), "V": normal(1, 3), "b": normal(3), **more.pop("weights", {})}
    return Net(nodes, weights, **more)


LAST = node("MatMul", "a W", "out")
SWITCH = [node("Softplus", "stress", "soft"), node("Greater", "stress twenty", "more"), node("Where", "more stress soft", "a")]
DOUBLED = node("MatMul", "a30 W", "out")
WRONG: dict[str, tuple[Net, str]] = {
    "word": (wrong([node("Erf", "stress", "a", name="act"), LAST]), r"operator Erf \(node act\) is not read; operators that are"),
    "nameless": (wrong([node("LayerNormalization", "stress b", "a"), LAST]), r"LayerNormalization \(of a\)"),
    "domain": (wrong([node("Relu", "stress", "a", domain="own"), LAST]), "operator own.Relu"),
    "width": (wrong([node("Identity", "stress", "a"), LAST], inputs=("N", 4)), r"shape \[0, 4\]"),
    "rank": (wrong([node("Identity", "stress", "a"), LAST], inputs=("N", 1, 3)), "shape"),
    "inputs": (wrong([node("Add", "stress x", "a"), LAST], more=[onnx.helper.make_tensor_value_info("x", 1, ["N", 3])]), "2 inputs and 1"),
    "outputs": (wrong([node("Relu", "stress", "out")], output=("N", 3)), "no single number"),
    "constant": (wrong([node("Identity", "W", "out")], output=(3, 1)), "no single number"),
    "batch": (wrong([node("Add", "stress c", "a"), LAST], weights={"c": normal(4, 3)}), r"numbers of the shape \(4, 3\)"),
    "wide": (wrong([node("Add", "stress c", "a"), LAST], weights={"c": normal(1, 1, 3)}), r"numbers of the shape \(1, 1, 3\)"),
    "lengths": (wrong([node("Add", "stress c", "a"), LAST], weights={"c": normal(2)}), "vectors with 3 and 2 parts"),
    "joined": (wrong([node("Concat", "V stress", "a", axis=0), LAST]), "Concat"),
    "rows": (wrong([node("Concat", "stress stress", "a", axis=0), LAST]), "Concat"),
    "turned": (wrong([node("Transpose", "stress", "a"), LAST]), "Transpose"),
    "columns": (wrong([node("MatMul", "V stress", "a"), LAST]), "MatMul"),
    "matrix": (wrong([node("MatMul", "stress b", "out")]), "MatMul"),
    "from": (wrong([node("MatMul", "stress c", "out")], weights={"c": normal(2, 1)}), "c has 2 numbers for each output; it takes 3"),
    "gemm": (wrong([node("Gemm", "stress W", "out", transA=1)]), "Gemm"),
    "scaled": (wrong([node("Gemm", "stress W", "out", alpha=0.5)]), "Gemm"),
    "weights": (wrong([node("Softplus", "n", "a"), node("MatMul", "stress a", "out")], weights={"n": np.ones((3, 1), "i8")}), "Softplus"),
    "grown": (
        wrong([node("Add", "tall flat", "a"), node("MatMul", "stress a", "out")], weights={"tall": normal(2000, 1), "flat": normal(2000)}),
        r"Add \(of a\)",
    ),
    "slope": (wrong([node("LeakyRelu", "stress", "a", alpha=1.5), LAST]), "LeakyRelu"),
    "half": (wrong([node("Cast", "stress", "a", to=10), LAST]), "Cast"),
    "dropped": (wrong([node("Dropout", "stress half yes", "a"), LAST], weights={"half": np.float32(0.5), "yes": np.True_}), "Dropout"),
    "ends": (wrong([node("Clip", "stress b", "a"), LAST]), "Clip"),
    "power": (wrong([node("Pow", "stress b", "a"), LAST]), "Pow"),
    "base": (wrong([node("Pow", "b stress", "a"), LAST]), "Pow"),
    "over rows": (wrong([node("ReduceMax", "stress", "a", axes=[0]), node("MatMul", "a W", "out")]), "ReduceMax"),
    "over all": (wrong([node("ReduceMax", "stress", "a"), node("MatMul", "a W", "out")]), "ReduceMax"),
    "row": (wrong([node("Gather", "stress zero", "a", axis=0), node("MatMul", "a W", "out")], weights={"zero": np.array(0)}), "Gather"),
    "rows of a batch": (
        wrong([node("Slice", "stress one two zero", "a"), LAST], weights={"one": [1], "two": [2], "zero": [0]}), r"Slice \(of a\)",
    ),
    "squeezed": (wrong([node("Squeeze", "stress", "a"), LAST]), "Squeeze"),
    "without an axis": (
        wrong([node("MatMul", "stress W", "p"), node("Squeeze", "p last", "q"), node("Add", "q p", "out")], weights={"last": [1]}),
        "joins vectors",
    ),
    "many numbers": (
        wrong([node("MatMul", "stress W", "p"), node("Squeeze", "p last", "q"), node("Add", "q b", "out")], weights={"last": [1]}),
        "numbers of the shape",
    ),
    "switch": (wrong([*SWITCH, LAST], weights={"twenty": np.float32(19.0)}), "Where"),
    "other": (wrong([*SWITCH[:2], node("Where", "more soft stress", "a"), LAST], weights={"twenty": np.float32(20.0)}), "Where"),
    "another": (
        wrong([node("Tanh", "stress", "v"), node("Softplus", "v", "soft"), *SWITCH[1:], LAST], weights={"twenty": np.float32(20.0)}),
        "Where",
    ),
    "sharper": (
        wrong(
            [
                node("Mul", "stress two", "v"), node("Softplus", "v", "w"), node("Div", "w three", "soft"),
                node("Greater", "v twenty", "more"), SWITCH[2], LAST,
            ],
            weights={"twenty": np.float32(20.0), "two": np.float32(2.0), "three": np.float32(3.0)},
        ),
        "Where",
    ),
    "nan": (wrong([node("MatMul", "stress c", "out")], weights={"c": np.full((3, 1), np.nan)}), "c holds a number that is not finite"),
    "kind": (wrong([node("MatMul", "stress c", "out")], weights={"c": np.ones((3, 1), "complex64")}), "c is no matrix of numbers"),
    "text": (wrong([node("Constant", "", "a", value_string="x"), LAST]), "Constant"),
    "axes": (wrong([node("Transpose", "W", "a", perm=[7, 9]), LAST]), "cannot be read: axis 7"),
    "many": (
        wrong([node("Relu", "stress", "a0"), *(node("Concat", 2 * f"a{k} ", f"a{k + 1}", axis=1) for k in range(30)), DOUBLED]),
        r"Concat \(of a12\)",
    ),
    "order": (wrong([LAST, node("Relu", "stress", "a")]), "cannot be read"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_not_read_is_told_with_its_node(tmp_path: Path, name: str) -> None:
    net, said = WRONG[name]
    with pytest.raises(InputError, match=said) as told:
        imported(tmp_path, net)
    assert told.value.remedy and "net.onnx" in told.value.where and not (tmp_path / "law.toml").exists()


def outside(model: Any) -> None:
    data = model.graph.initializer[0]
    data.ClearField("raw_data")
    data.data_location = onnx.TensorProto.EXTERNAL
    data.external_data.add(key="location", value="../secret")


SPOILED: dict[str, tuple[Callable[[Any], Any], str]] = {
    "old": (lambda model: setattr(model.opset_import[0], "version", 6), "operators of version 6, and those of versions 7 to"),
    "unknown": (lambda model: setattr(model.opset_import[0], "version", 999), "operators of version 999"),
    "function": (lambda model: model.functions.add(name="MatMul", domain="", output=["a"]), "a function of its own for the operator M"),
    "type": (lambda model: setattr(model.graph.initializer[0], "data_type", 99), "cannot be read"),
    "outside": (outside, "cannot be read: .*k0"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_a_file_that_says_something_else_than_it_seems_is_refused(tmp_path: Path, name: str) -> None:
    (folder := tmp_path / "inner").mkdir()
    (tmp_path / "secret").write_bytes(np.ones(3, "f4").tobytes())
    spoil, said = SPOILED[name]
    file = KERAS.write(folder)
    model = onnx.load(file)
    spoil(model)
    file.write_bytes(model.SerializeToString())
    with pytest.raises(InputError, match=said):
        onnx_network(file, "law", forces=["a", "b", "c"], stem="law")


CALLS: list[tuple[Callable[[Path], Any], str]] = [
    (lambda folder: (folder / "net.onnx").write_bytes(b"\x00nothing"), "cannot be read"), (lambda _: None, "no such file"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "said"), CALLS)
def test_a_file_that_is_none_is_told(tmp_path: Path, make: Callable[[Path], Any], said: str) -> None:
    make(tmp_path)
    with pytest.raises(InputError, match=said):
        onnx_network(tmp_path / "net.onnx", "law", forces=["a"], stem="law")


@pytest.mark.parametrize("asked", [("--kind", "polynomial"), ("--activation", "relu")])
def test_an_option_that_the_file_answers_is_refused(tmp_path: Path, asked: tuple[str, str]) -> None:
    with pytest.raises(InputError, match="a network and its activations"):
        imported(tmp_path, KERAS, *asked)
