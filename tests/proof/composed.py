"""What composition shows of a law's formula, asked of the kernel and of the prover, each by itself."""

from __future__ import annotations

from duhem import Criterion
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw
from tests.oracles.prover.curvature import curvature
from tests.oracles.prover.decide import AskedSubject

__all__ = ["by_kernel", "by_prover"]


def by_kernel(criterion: Criterion) -> Facts:
    """The facts that the kernel shows of g as written."""
    stated = StatedLaw.read(law_as_text(criterion))
    return over(stated).facts(stated.g)


def by_prover(criterion: Criterion) -> bool:
    """Whether the prover shows g quasiconvex."""
    subject = AskedSubject(criterion)
    subject.allow(20_000_000)
    return curvature(subject.simple.g, subject).quasiconvex
