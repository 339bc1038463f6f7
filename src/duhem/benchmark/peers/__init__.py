"""Other programs that find the same closest point, each as a method beside duhem's own: measured where installed, never needed."""

from duhem.benchmark.peers.known import PEERS, Peer
from duhem.benchmark.peers.peer import PeerOptions

__all__ = ["PEERS", "Peer", "PeerOptions"]
