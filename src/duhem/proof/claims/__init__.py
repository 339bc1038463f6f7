"""The seven claims, in the order in which they rest on each other."""

from collections.abc import Mapping
from types import MappingProxyType

from duhem.proof.claims import convexity, dissipation, duality, normality, origin, smoothness, state_laws
from duhem.proof.claims.claim import Claim

__all__ = ["CLAIMS", "Claim"]

CLAIMS: Mapping[str, Claim] = MappingProxyType(
    {m.CLAIM.name: m.CLAIM for m in (origin, convexity, smoothness, normality, dissipation, duality, state_laws)}
)
