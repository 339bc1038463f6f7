"""Networks of PyTorch, and the files that it writes of them: python -m tests.law.pytorch.networks FOLDER

The files in this folder were written by PyTorch 2.13 and stay as they are, so that tests read them where PyTorch is missing; only what
names places on the machine that wrote them, the traces of source lines and the two text fields of ONNX, is left out.
"""

from __future__ import annotations

import json
import sys
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.nn import functional

__all__ = ["FORMS", "NETWORKS", "values", "write"]

FORMS = ("pt2", "dynamo.onnx", "legacy.onnx")  # what a network is saved as
Activation = Callable[[torch.Tensor], torch.Tensor]


class InputConvex(nn.Module):
    """z_0 = a(A_0 x + c_0), z_k = a(W_k z_(k-1) + A_k x + c_k) with W_k >= 0, of a stress that is scaled; one number a row."""

    def __init__(self, width: int, depth: int, activation: Activation, kept: Activation) -> None:
        super().__init__()
        ends = [width] * depth + [1]
        self.skips = nn.ModuleList([nn.Linear(3, n) for n in ends])
        self.layers = nn.ModuleList([nn.Linear(width, n, bias=False) for n in ends[1:]])
        self.activation, self.kept = activation, kept
        self.register_buffer("mean", torch.tensor([0.1, -0.2, 0.3]))
        self.register_buffer("size", torch.tensor([1.5, 1.0, 0.5]))

    def forward(self, stress: torch.Tensor) -> torch.Tensor:
        x = (stress - self.mean) / self.size
        z = self.skips[0](x)
        for skip, layer in zip(self.skips[1:], self.layers, strict=True):
            z = functional.linear(self.activation(z), self.kept(layer.weight)) + skip(x)
        return z.squeeze(-1)


class Joined(nn.Module):
    """The stress joined to what the second layer reads, and a quadratic form."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.second, self.last = nn.Linear(3, 5), nn.Linear(8, 4), nn.Linear(4, 1)
        self.form = nn.utils.parametrizations.weight_norm(nn.Linear(2, 3, bias=False))

    def forward(self, stress: torch.Tensor) -> torch.Tensor:
        z = functional.leaky_relu(self.first(stress), 0.1)
        z = functional.silu(self.second(torch.cat([z, stress], dim=-1)))
        return 2.5 * self.last(z) + (self.form(stress[:, :2]) ** 2).sum(-1, keepdim=True)


class Invariants(nn.Module):
    """Of differences of stresses, in matrices and vectors without layers, in double precision inside."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.shift = nn.Parameter(torch.randn(6, 3).double()), nn.Parameter(torch.randn(6).double())
        self.last = nn.Parameter(torch.randn(1, 6).double())

    def forward(self, stress: torch.Tensor) -> torch.Tensor:
        s = stress.double()
        parts = torch.stack([s[:, 0] - s[:, 1], s[:, 1] * s[:, 2], 1 - s[:, 2]], dim=-1)
        z = functional.softplus(parts @ self.first.T + self.shift, beta=3.0)
        return (z @ functional.softplus(self.last).T)[:, 0].float()


def _plain(activation: nn.Module) -> nn.Module:
    return nn.Sequential(nn.Linear(3, 6), activation, nn.Dropout(0.1), nn.Linear(6, 6), activation, nn.Linear(6, 1))


NETWORKS: dict[str, Callable[[], nn.Module]] = {
    "convex": lambda: InputConvex(5, 2, functional.softplus, lambda w: w.clamp(min=0)),
    "joined": Joined,
    "invariants": Invariants,
    "softplus-64": lambda: InputConvex(64, 2, functional.softplus, functional.softplus),
    "relu-64": lambda: InputConvex(64, 3, functional.relu, torch.abs),
    **{name: lambda name=name: _plain(getattr(nn, name)()) for name in ("Tanh", "ReLU", "Softplus", "ELU", "CELU", "SiLU", "Sigmoid")},
}


def write(folder: Path, name: str) -> nn.Module:
    """The network of this name, written into ``folder`` in every form."""
    torch.manual_seed(len(name))
    made, example = NETWORKS[name]().eval(), (torch.zeros(2, 3),)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # PyTorch tells of what is to go in later versions of itself
        torch.export.save(torch.export.export(made, example), folder / f"{name}.pt2")
        torch.onnx.export(made, example, folder / f"{name}.dynamo.onnx", dynamo=True, verbose=False)
        torch.onnx.export(made, example, folder / f"{name}.legacy.onnx", dynamo=False)
    return made


def values(network: nn.Module, at: np.ndarray) -> np.ndarray:
    with torch.no_grad():
        return np.ravel(network(torch.from_numpy(at)).numpy())


def _keep(folder: Path, names: list[str]) -> None:
    """Write the files of this folder."""
    import onnx

    at = np.random.default_rng(1).normal(size=(50, 3)).astype("f4") * np.float32(3)
    found = {name: values(write(folder, name), at) for name in names}
    np.savez(folder / "values.npz", at=at, **found)
    for name in names:
        old = zipfile.ZipFile(folder / f"{name}.pt2")
        parts = {each: old.read(each) for each in old.namelist()}
        with zipfile.ZipFile(folder / f"{name}.pt2", "w", zipfile.ZIP_DEFLATED) as new:
            for each, text in parts.items():
                if each.endswith("/model.json"):
                    model = json.loads(text)
                    for node in model["graph_module"]["graph"]["nodes"]:
                        node["metadata"] = {}
                    text = json.dumps(model).encode()
                new.writestr(each, text)
        for form in FORMS[1:]:
            file = folder / f"{name}.{form}"
            model = onnx.load(file, load_external_data=False)
            model.graph.doc_string = model.doc_string = ""
            for node in model.graph.node:
                del node.metadata_props[:]
            file.write_bytes(model.SerializeToString())


if __name__ == "__main__":
    _keep(Path(sys.argv[1]), ["convex", "joined", "invariants"])
