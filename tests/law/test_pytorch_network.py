"""A network that PyTorch wrote is the law that it was there: files that are kept, and files written anew where PyTorch is installed."""

from __future__ import annotations

import contextlib
import io
import json
import pickle
import shlex
import subprocess
import sys
import zipfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from duhem import load
from duhem.cli import cli
from duhem.errors import InputError
from duhem.expression import numpy_
from duhem.law.network import pt2_network
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from tests.pages import ROOT, blocks, named

KEPT = Path(__file__).parent / "pytorch"
VALUES = np.load(KEPT / "values.npz")
FORMS = ("pt2", "dynamo.onnx", "legacy.onnx")
WITH_TORCH = pytest.mark.skipif(not find_spec("torch") or not find_spec("onnxscript"), reason="PyTorch or onnxscript is not installed")


def imported(file: Path, folder: Path, level: str = "0") -> Any:
    if file.suffix == ".onnx":
        pytest.importorskip("onnx")
    asked = ["import", f"{file}", "--out", f"{folder / 'law.toml'}", "--stress", "plane", "--level", level]
    cli.main(asked, standalone_mode=False)
    return load(folder / "law.toml")


def agrees(law: Any, at: Any, wanted: Any) -> None:
    """Within what float32 tells apart of the sums that a network makes."""
    found = numpy_.compiled(law.g, law.force_symbols())(*at.T.astype(float))
    assert np.all(abs(found - wanted) <= 3e-6 * (abs(wanted) + abs(wanted).max()))


def is_convex(law: Any) -> bool:
    return not objection("convexity", "composition", frozenset(), stated(law_as_text(law)), {})


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", ["convex", "joined", "invariants"])
def test_a_file_that_is_kept_is_the_network_that_it_was(tmp_path: Path, name: str, form: str) -> None:
    law = imported(KEPT / f"{name}.{form}", tmp_path)
    agrees(law, VALUES["at"], VALUES[name])
    assert is_convex(law) == (name == "convex")


PAGE = ROOT / "docs" / "how-to" / "learned-laws.md"
LINES = {named(block): block for block in blocks(PAGE.read_text("utf-8"), "py")}
TYPED = [block for block in blocks(PAGE.read_text("utf-8"), "sh") if block.startswith("duhem import")]


@pytest.mark.parametrize(("scripts", "needs", "typed"), [
    (("save_pytorch.py",), ("torch",), "net.pt2"), (("save_pytorch.py", "save_onnx.py"), ("torch", "onnxscript", "onnx"), "net.onnx"),
    (("save_jaxmat.py",), ("jaxmat",), "jaxmat.npz"), (("save_jaxmat_skip.py",), ("jaxmat",), "skip.npz"),
])  # fmt: skip
def test_the_lines_of_the_page_make_a_law_that_is_the_network(tmp_path: Path, scripts: Any, needs: Any, typed: str) -> None:
    for package in needs:
        if not find_spec(package):
            pytest.skip(f"{package} is not installed")
    for script in scripts:
        (tmp_path / script).write_text(LINES[script], "utf-8")
    at = (2.0 * np.random.default_rng(4).normal(size=(10_000, 3))).astype("f4")
    np.save(tmp_path / "at.npy", at)
    batch = "net(torch.tensor(at)).detach()" if "torch" in needs else "jax.vmap(net)(at)"
    asked = f"from {scripts[0].removesuffix('.py')} import *\nimport numpy as np\nat = np.load('at.npy')\nnp.save('values.npy', {batch})"
    (tmp_path / "ask.py").write_text(asked, "utf-8")
    for script in (*scripts, "ask.py"):
        subprocess.run([sys.executable, script], cwd=tmp_path, check=True, capture_output=True)
    (line,) = [block.split("\n")[0] for block in TYPED if f" {typed} " in block]
    _, *words = shlex.split(line)
    with contextlib.chdir(tmp_path):
        cli.main(words, standalone_mode=False)
    law = load(tmp_path / words[words.index("--out") + 1])
    agrees(law, at, np.load(tmp_path / "values.npy") - float(words[words.index("--level") + 1]))
    assert is_convex(law)


@WITH_TORCH
@pytest.mark.parametrize(
    "name", ["convex", "joined", "invariants", "softplus-64", "relu-64", "Tanh", "ReLU", "Softplus", "ELU", "CELU", "SiLU", "Sigmoid"]
)
def test_a_file_written_anew_is_the_network_at_many_points(tmp_path: Path, name: str) -> None:
    from tests.law.pytorch.networks import values, write

    network = write(tmp_path, name)
    many = np.random.default_rng(2).normal(size=(10_000, 3)).astype("f4")
    scales = (0.5, 3.0) if name == "invariants" else (0.5, 3.0, 100.0)  # products overflow in exp; 100 is where PyTorch has x for softplus
    for form in FORMS:
        (folder := tmp_path / form).mkdir()
        law = imported(tmp_path / f"{name}.{form}", folder)
        for scale in scales:
            agrees(law, many * np.float32(scale), values(network, many * np.float32(scale)))
        assert name not in ("convex", "softplus-64", "relu-64") or is_convex(law)


def changed(folder: Path, change: Callable[[dict[str, bytes]], Any], name: str = "convex") -> Path:
    """A kept .pt2 file with other entries."""
    old = zipfile.ZipFile(KEPT / f"{name}.pt2")
    parts = {each: old.read(each) for each in old.namelist()}
    change(parts)
    with zipfile.ZipFile(folder / "net.pt2", "w") as new:
        for each, text in parts.items():
            new.writestr(each, text)
    return folder / "net.pt2"


class Trap:
    """Once read from a pickle, it leaves a file."""

    def __init__(self, place: str) -> None:
        self.place = place

    def __reduce__(self) -> Any:
        return Path.touch, (Path(self.place),)


def test_a_pickle_in_the_file_is_never_opened(tmp_path: Path) -> None:
    trap = pickle.dumps(Trap(f"{tmp_path / 'sprung'}"))
    pickle.load(io.BytesIO(trap))
    assert (tmp_path / "sprung").exists()
    (tmp_path / "sprung").unlink()
    file = changed(tmp_path, lambda parts: parts.update({"convex/data/sample_inputs/model.pt": trap, "convex/extra/trap.pkl": trap}))
    agrees(imported(file, tmp_path), VALUES["at"], VALUES["convex"])
    assert not (tmp_path / "sprung").exists()


def at(entry: str, *path: Any) -> Callable[[Any], Callable[[dict[str, bytes]], None]]:
    """What puts a value into the JSON of an entry."""

    def put(value: Any) -> Callable[[dict[str, bytes]], None]:
        def change(parts: dict[str, bytes]) -> None:
            tree = inner = json.loads(parts[f"convex/{entry}"])
            for key in path[:-1]:
                inner = inner[key]
            inner[path[-1]] = value
            parts[f"convex/{entry}"] = json.dumps(tree).encode()

        return change

    return put


MODEL, WEIGHTS = "models/model.json", "data/weights/model_weights_config.json"
META = (WEIGHTS, "config", "skips.0.weight", "tensor_meta")
NODES = (MODEL, "graph_module", "graph", "nodes")
SPOILED: dict[str, tuple[Callable[[dict[str, bytes]], Any], str]] = {
    "pickled": (at(WEIGHTS, "config", "skips.0.weight", "use_pickle")(True), "skips.0.weight is not kept as plain numbers"),
    "missing": (at(WEIGHTS, "config")({}), "mean is not kept as plain|skips.0.weight is not kept as plain"),
    "kind": (at(*META, "dtype")(13), "not kept as plain numbers"),
    "strides": (at(*META, "strides")([{"as_int": 10**6}, {"as_int": 1}]), "cannot be read: index"),
    "before": (at(*META, "storage_offset")({"as_int": -5}), "has the sizes"),
    "huge": (at(*META, "sizes")([{"as_int": 10**9}, {"as_int": 3}]), "has the sizes .*at most 1000000"),
    "version": (at(MODEL, "schema_version", "major")(9), "the graph is of version 9, and 8 is read"),
    "older": (lambda parts: parts.pop(f"convex/{MODEL}"), "no graph that can be read without running"),
    "two": (lambda parts: parts.update({"other/models/model.json": b"{}"}), "no graph"),
    "text": (lambda parts: parts.update({f"convex/{MODEL}": b"{"}), "cannot be read"),
    "order": (lambda parts: parts.update({"convex/byteorder": b"odd"}), "cannot be read"),
    "operator": (at(*NODES, 0, "target")("torch.ops.aten.erf.default"), r"torch.ops.aten.erf.default \(of sub\) is not read"),
    "python": (at(*NODES, 0, "target")("_operator.sub"), r"_operator.sub \(of sub\) is not read"),
    "scaled": (at(*NODES, 0, "inputs")([{"name": "alpha", "arg": {"as_int": 2}}]), "is not read"),
    "string": (at(*NODES, 1, "inputs", 1)({"name": "rounding_mode", "arg": {"as_string": "floor"}}), "takes string"),
    "switch": (
        at(*NODES, 3)({
            "target": "torch.ops.aten.softplus.default", "outputs": [{"as_tensor": {"name": "softplus"}}],
            "inputs": [{"name": "self", "arg": {"as_tensor": {"name": "linear"}}}, {"name": "threshold", "arg": {"as_float": 3.0}}],
        }),
        "softplus.default",
    ),
    "input": (at(MODEL, "graph_module", "signature", "input_specs", 0)({"token": {"arg": {"name": "x"}}}), "takes a token"),
}  # fmt: skip


def test_weights_may_be_made_of_a_single_number(tmp_path: Path) -> None:
    def of_one(parts: dict[str, bytes]) -> None:
        at(WEIGHTS, "config", "mean", "tensor_meta", "sizes")([])(parts)
        at(WEIGHTS, "config", "mean", "tensor_meta", "strides")([])(parts)
        nodes = json.loads(parts[f"convex/{MODEL}"])["graph_module"]["graph"]["nodes"]
        mean = next(each for each in nodes[0]["inputs"] if each["name"] == "other")
        made = {"name": "other", "arg": {"as_tensor": {"name": "made"}}}
        first = {"target": "torch.ops.aten.exp.default", "inputs": [mean | {"name": "self"}], "outputs": [{"as_tensor": {"name": "made"}}]}
        rest = [{**nodes[0], "inputs": [made if each is mean else each for each in nodes[0]["inputs"]]}, *nodes[1:]]
        at(*NODES)([first, *rest])(parts)

    with zipfile.ZipFile(KEPT / "convex.pt2") as kept:
        path = json.loads(kept.read(f"convex/{WEIGHTS}"))["config"]["mean"]["path_name"]
        mean = np.frombuffer(kept.read(f"convex/data/weights/{path}"), "f4")
    moved = VALUES["at"] - mean + np.exp(mean[0])
    agrees(imported(changed(tmp_path, of_one), tmp_path), moved, VALUES["convex"])


@pytest.mark.parametrize("name", SPOILED)
def test_what_is_not_read_is_told(tmp_path: Path, name: str) -> None:
    change, said = SPOILED[name]
    with pytest.raises(InputError, match=said) as told:
        pt2_network(changed(tmp_path, change), "law", forces=["a", "b", "c"], stem="law")
    assert told.value.remedy and "net.pt2" in told.value.where


@pytest.mark.parametrize(("text", "said"), [(None, "no such file"), (b"nothing", "cannot be read"), (b"PK\x03\x04", "cannot be read")])
def test_a_file_that_is_none_is_told(tmp_path: Path, text: bytes | None, said: str) -> None:
    if text is not None:
        (tmp_path / "net.pt2").write_bytes(text)
    with pytest.raises(InputError, match=said):
        pt2_network(tmp_path / "net.pt2", "law", forces=["a"], stem="law")
