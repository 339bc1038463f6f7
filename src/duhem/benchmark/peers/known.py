"""The peers by name: what to install, and where the adapter is; each is imported when it is measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

from duhem.benchmark.peers.peer import PeerOptions
from duhem.projection.method import Method

__all__ = ["PEERS", "Peer"]


@dataclass(frozen=True)
class Peer:
    """Another program under the name it has in tables: ``package`` is imported, ``distribution`` is what pip installs."""

    name: str
    package: str
    distribution: str
    load: Callable[[], Method[PeerOptions]]

    @property
    def missing(self) -> str | None:
        """What to install, None where it is there."""
        return None if find_spec(self.package) else f"not installed, pip install {self.distribution}"


def _slsqp() -> Method[PeerOptions]:
    from duhem.benchmark.peers.scipy_slsqp import SLSQP

    return SLSQP


def _jaxmat() -> Method[PeerOptions]:
    from duhem.benchmark.peers.jaxmat_return import JAXMAT

    return JAXMAT


def _qpax() -> Method[PeerOptions]:
    from duhem.benchmark.peers.qpax_program import QPAX

    return QPAX


def _proxqp() -> Method[PeerOptions]:
    from duhem.benchmark.peers.proxqp_program import PROXQP

    return PROXQP


PEERS = (
    Peer("scipy SLSQP", "scipy", "scipy", _slsqp),
    Peer("jaxmat", "jaxmat", "jaxmat", _jaxmat),
    Peer("qpax", "qpax", "qpax", _qpax),
    Peer("proxqp", "proxsuite", "proxsuite", _proxqp),
)
