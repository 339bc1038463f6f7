"""A learned law that is imported is the network that it was, in the exact values of its weights."""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from duhem import load, verify
from duhem.cli import cli
from duhem.errors import InputError, MissingExtraError
from duhem.expression import numpy_

RNG = np.random.default_rng(0)
ICNN = {
    "Wx0": RNG.normal(size=(8, 3)), "b0": RNG.normal(size=8), "Wz1": abs(RNG.normal(size=(8, 8))) / 8, "Wx1": RNG.normal(size=(8, 3)),
    "b1": RNG.normal(size=8), "Wz2": abs(RNG.normal(size=(1, 8))), "b2": RNG.normal(size=1),
}  # fmt: skip
MLP = {"W0": RNG.normal(size=(6, 2)), "b0": RNG.normal(size=6), "W1": RNG.normal(size=(1, 6))}
POLYNOMIAL = {"coefficients": np.array([1.0, 0.5, 2.0]), "exponents": np.array([[2, 0], [0, 2], [1, 3]])}


def imported(folder: Path, arrays: dict[str, Any], *asked: str, kind: str = "icnn") -> Path:
    np.savez(folder / "net.npz", **arrays)
    cli.main(["import", f"{folder / 'net.npz'}", "--kind", kind, "--out", f"{folder / 'law.toml'}", *asked], standalone_mode=False)
    return folder / "law.toml"


def agrees(file: Path, value: Any, most: float) -> None:
    law, at = load(file), np.random.default_rng(1).normal(size=(10_000, len(load(file).forces)))
    assert numpy_.compiled(law.g, law.force_symbols())(*at.T) == pytest.approx(value(at), rel=most, abs=most)


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.float16])
def test_an_input_convex_network_is_the_same_and_is_proved(tmp_path: Path, kind: Any) -> None:
    arrays = {name: array.astype(kind) for name, array in ICNN.items()}
    file = imported(tmp_path, arrays, "--stress", "plane", "--level", "9.5", "--activation", "relu")
    w = {name: array.astype(float) for name, array in arrays.items()}

    def value(x: Any) -> Any:
        z = np.maximum(x @ w["Wx0"].T + w["b0"], 0.0)
        z = np.maximum(z @ w["Wz1"].T + x @ w["Wx1"].T + w["b1"], 0.0)
        return z @ w["Wz2"][0] + w["b2"][0] - 9.5

    agrees(file, value, 1e-12)
    written = (tmp_path / "law_Wz1.csv").read_text("utf-8").split("\n")[0].split(",")
    assert [Fraction(x) for x in written] == [Fraction(float(x)) for x in arrays["Wz1"][0]]
    assert verify(load(file), claims=["convexity"])["convexity"].trust == "checked"


@pytest.mark.parametrize("small", [1e-300, -5e-324])
def test_a_number_that_cannot_be_written_exactly_is_refused_at_once(tmp_path: Path, small: float) -> None:
    with pytest.raises(InputError, match="more than 400 digits"):
        imported(tmp_path, {**ICNN, "b2": np.array([small])}, "--stress", "plane")
    assert not (tmp_path / "law.toml").exists()


def test_a_plain_network_and_a_polynomial_are_the_same(tmp_path: Path) -> None:
    file = imported(tmp_path, MLP, "--forces", "a, b", "--activation", "tanh", kind="mlp")
    agrees(file, lambda x: np.tanh(x @ MLP["W0"].T + MLP["b0"]) @ MLP["W1"][0], 1e-12)
    file = imported(tmp_path, POLYNOMIAL, "--forces", "a,b", "--level", "1/4", kind="polynomial")
    agrees(file, lambda x: x[:, 0] ** 2 + 0.5 * x[:, 1] ** 2 + 2.0 * x[:, 0] * x[:, 1] ** 3 - 0.25, 1e-12)


WRONG: list[tuple[dict[str, Any], str, tuple[str, ...]]] = [
    ({"Wx0": None}, "no array Wx0", ()), ({"Wz1": np.ones((8, 7))}, "takes n x 8", ()), ({"b1": np.ones(7)}, "takes 8 x 1", ()),
    ({"more": np.ones(3)}, "is not used", ()), ({"Wz2": np.ones((2, 8)), "b2": np.ones(2)}, "2 outputs", ()),
    ({"b0": np.full(8, np.nan)}, "not finite", ()), ({"b0": np.full(8, np.inf)}, "not finite", ()),
    ({"b0": np.array(["a"] * 8)}, "no matrix", ()),
    ({"Wx0": np.ones((8, 3, 1))}, "no matrix", ()), ({}, "not named", ("--stress", "plane", "--forces", "a,b,c")),
    ({}, "x 6", ("--stress", "3d")),
    ({"b0": np.ones(8, dtype=complex)}, "no matrix", ()), ({"b0": np.array([object()] * 8)}, "cannot be read", ()),
]  # fmt: skip


@pytest.mark.parametrize(("change", "said", "asked"), WRONG)
def test_what_is_no_such_network_is_told(tmp_path: Path, change: dict[str, Any], said: str, asked: tuple[str, ...]) -> None:
    arrays = {name: array for name, array in {**ICNN, **change}.items() if array is not None}
    with pytest.raises(InputError, match=said):
        imported(tmp_path, arrays, *(asked or ("--stress", "plane")))
    assert not (tmp_path / "law.toml").exists()


def test_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.npz").write_bytes(b"PK\x03\x04nothing")
    for name, said in (("net.pt", "only .npz.*torch.export.save"), ("missing.npz", "no such file"), ("bad.npz", "cannot be read")):
        asked = ["import", f"{tmp_path / name}", "--kind", "mlp", "--out", f"{tmp_path / 'o.toml'}", "--forces", "a"]
        with pytest.raises(InputError, match=said):
            cli.main(asked, standalone_mode=False)


def test_what_was_learned_must_be_said_of_arrays(tmp_path: Path) -> None:
    np.savez(tmp_path / "net.npz", **MLP)
    with pytest.raises(InputError, match="give icnn, mlp or polynomial"):
        cli.main(["import", f"{tmp_path / 'net.npz'}", "--out", f"{tmp_path / 'o.toml'}", "--forces", "a,b"], standalone_mode=False)


def test_without_the_extra_an_onnx_file_is_refused_with_the_command_that_installs_it(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "onnx", None)
    asked = ["import", f"{tmp_path / 'net.onnx'}", "--out", f"{tmp_path / 'o.toml'}", "--forces", "a"]
    with pytest.raises(MissingExtraError, match=r'pip install "duhem\[learned\]"'):
        cli.main(asked, standalone_mode=False)


def softplus(x: Any) -> Any:
    return np.logaddexp(np.float32(0.0), x)


def test_arrays_of_other_programs_have_the_places_that_the_page_names(tmp_path: Path) -> None:
    """Dense layers of Flax, whose kernels are (inputs, outputs), and jaxmat's ICNN, which reads its weights through softplus."""
    shapes = [(8, 3), (8, 8), (1, 8)]
    raw = [RNG.normal(size=shape).astype(np.float32) for shape in shapes]
    shifts = [RNG.normal(size=n).astype(np.float32) for n, _ in shapes]
    params = {f"Dense_{k}": {"kernel": w.T, "bias": b} for k, (w, b) in enumerate(zip(raw, shifts, strict=True))}
    dense = {f"W{k}": params[f"Dense_{k}"]["kernel"].T for k in range(3)} | {f"b{k}": params[f"Dense_{k}"]["bias"] for k in range(3)}
    file = imported(tmp_path, dense, "--stress", "plane", "--activation", "tanh", kind="mlp")

    def flax(x: Any) -> Any:
        for k in range(3):
            x = x @ params[f"Dense_{k}"]["kernel"].astype(float) + params[f"Dense_{k}"]["bias"]
            x = np.tanh(x) if k < 2 else x
        return x[:, 0]

    agrees(file, flax, 1e-12)
    kept = {f"W{k}": softplus(w) for k, w in enumerate(raw)} | {f"b{k}": b for k, b in enumerate(shifts[:2])}
    file = imported(tmp_path, kept, "--stress", "plane", "--activation", "softplus", "--level", "40", kind="mlp")

    def jaxmat(x: Any) -> Any:
        z = x.astype(np.float32)
        for w, b in zip(raw[:2], shifts[:2], strict=True):
            z = softplus(z @ softplus(w).T + b)
        return (z @ softplus(raw[2]).T)[:, 0] - 40.0

    agrees(file, jaxmat, 1e-5)
    assert verify(load(file), claims=["convexity"])["convexity"].trust == "checked"
