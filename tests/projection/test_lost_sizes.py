"""Where the size of K, or all that g changes by, is lost in doubles, an answer is right or flagged."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import duhem
from duhem import POSITIVE, Criterion, Status
from duhem.projection.scaled_formula import may_cancel
from tests.campaigns.number_families import mp
from tests.long import long_but

N, X = "norm(sigma_a, sigma_b)", "abs(sigma_n)"
WAY = np.array([0.6, 0.8])
REFUSED = Status.INACCURATE, Status.FAILED

# the size of K as text, and in many digits
SIZES: list[tuple[str, Any]] = [
    ("log(cosh(X))", lambda x: mp.log(mp.cosh(x))),
    ("log(norm(1, X))", lambda x: mp.log1p(x * x) / 2),
    ("sqrt(log(norm(1, X)))", lambda x: mp.sqrt(mp.log1p(x * x) / 2)),
    ("acos(exp(-X))", lambda x: mp.acos(mp.exp(-x))),
    ("log(2**X)", lambda x: x * mp.log(2)),
    ("log(max(exp(X), 1))", lambda x: x),
    ("X*log(cosh(X))", lambda x: x * mp.log(mp.cosh(x))),
    ("log(1 + X**2)", lambda x: mp.log1p(x * x)),
    ("acos(1/(1 + X))", lambda x: mp.acos(1 / (1 + x))),
    ("sin(pi*exp(-X))", lambda x: mp.sin(mp.pi * mp.exp(-x))),
]


def asked(formula: str, trial: Any, pressure: float, copies: int, **parameters: float) -> Any:
    law = Criterion("law", formula, parameters=dict.fromkeys(parameters, POSITIVE))
    return duhem.project(law, np.repeat([trial], copies, axis=0), pressure, parameters=parameters or None, convex="assume")


@pytest.mark.slow
@pytest.mark.parametrize(("size", "exact"), long_but([1, 3], SIZES))
def test_a_size_in_which_digits_cancel_is_known(size: str, exact: Any) -> None:
    for pressure in (1e-4, 1e-9, 1e-17):
        radius = float(exact(mp.mpf(pressure)))
        for far in (0.5, 3.0, 1e6, 1e9, 1e13):
            done = asked(f"{N} - {size.replace('X', X)}", WAY * radius * far, -pressure, 1)
            assert done.status[0] == (Status.STICK if far < 1.0 else Status.SLIP), (pressure, far)
            np.testing.assert_allclose(done.stress[0], WAY * radius * min(far, 1.0), rtol=1e-9)


@pytest.mark.slow
def test_so_is_one_of_parameters() -> None:
    done = asked(f"{N} - log(1 + mu)*{X}", WAY * 1e-8, -1.0, 1, mu=1e-17)
    assert done.status[0] == Status.SLIP
    np.testing.assert_allclose(done.stress[0], WAY * 1e-17, rtol=1e-12)


SATURATED = [
    (f"tanh({N}) - tanh({X})", [8e4, 0.0], -800.0),
    (f"exp(-{X}) - exp(-{N})", [8e4, 0.0], -800.0),
    (f"{N}**8/(1 + {N}**8) - {X}**8/(1 + {X}**8)", [1e11, 0.0], -1e9),
]


@pytest.mark.slow
@pytest.mark.parametrize("copies", [1, 40])
@pytest.mark.parametrize(("formula", "trial", "pressure"), SATURATED)
def test_nothing_sticks_where_g_is_flat(formula: str, trial: Any, pressure: float, copies: int) -> None:
    """In doubles g is 0 there, and its slope is none; K is the disc of radius |sigma_n|."""
    done = asked(formula, trial, pressure, copies)
    off = np.abs(done.stress - np.array([[-pressure, 0.0]])).max(axis=1) / -pressure
    assert ((off <= 1e-7) | np.isin(done.status, REFUSED)).all()


LOST = [
    (f"(mu + {N})/(mu + {X}) - 1", WAY * 10.0, -1e-8, 1e12),
    (f"(mu + {N})/(mu + {X}) - 1", WAY * 1e-3, -1e-12, 1e6),
    (f"log((mu + {N})/(mu + {X}))", WAY * 10.0, -1e-8, 1e12),
    (f"exp({N}/mu) - 1 - {X}/mu", WAY * 10.0, -1e-8, 1e12),
    (f"mu*(exp({N}) - 1 - {X})", WAY * 1e-8, -1e-17, 1.0),
    (f"mu*((1 + {N})**2 - (1 + {X})**2)", WAY * 1e-8, -1e-17, 1.0),
    (f"norm(sigma_a, sigma_b, mu) - mu - {X}", WAY * 4.5e17, -1e-17, 1e12),
]


@pytest.mark.parametrize("copies", [1, 40])
@pytest.mark.parametrize(
    ("formula", "trial", "pressure", "mu"),
    [LOST[0], LOST[4], *(pytest.param(*case, marks=pytest.mark.long) for case in (*LOST[1:4], *LOST[5:]))],
)
def test_no_stress_is_not_right_where_k_holds_more(formula: str, trial: Any, pressure: float, mu: float, copies: int) -> None:
    done = asked(formula, trial, pressure, copies, mu=mu)
    assert ((done.stress != 0.0).any(axis=1) | np.isin(done.status, REFUSED)).all()


def test_no_stress_is_right_where_k_is_a_point_or_below_doubles() -> None:
    assert asked(f"{N} - 3/10*{X}", [1.0, 2.0], 0.0, 40).status.tolist() == [Status.SLIP] * 40
    assert asked(f"{N} - mu*{X}", [1.0, 2.0], -1e-300, 1, mu=1e-30).status.tolist() == [Status.SLIP]


def test_what_only_multiplies_loses_no_digits() -> None:
    law = Criterion("law", f"{N} - 3/10*{X}**(3/2)*max({X}, 2) - 1")
    loads = {part for part in law.g.args if not part.has(*law.force_symbols())}
    assert len(loads) == 2 and not any(map(may_cancel, loads))
    assert all(may_cancel(Criterion("law", f"{N} - {size.replace('X', X)}").g) for size, _ in SIZES)


def test_a_word_that_cannot_compare_what_has_no_value_is_no_crash() -> None:
    done = duhem.project(Criterion("law", f"{N} - where(cos(atan2(sigma_b, sigma_a)) > 0, {X}, 2*{X})"), [1.0, 2.0], -1.0)
    np.testing.assert_allclose(done.stress[0], np.array([1.0, 2.0]) / np.sqrt(5.0))


def test_what_leaves_the_range_of_doubles_warns_of_nothing() -> None:
    assert duhem.project(Criterion("law", f"atan2({X}, {N}) - pi/4"), [1.0, 2.0], -1e300).status[0] in REFUSED


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "status"),
    [("atan(log(x)) - 1/2", Status.SLIP), ("atan(1/x) - 1/2", Status.STICK), ("atan(log(abs(x))) - 1/2", Status.SLIP)],
)
def test_a_formula_that_is_between_two_numbers_where_no_force_acts_is_solved_elsewhere(g: str, status: Status) -> None:
    """SymPy makes bounds of atan at what is infinite; no answer is a message about these."""
    law = Criterion("bounds", g, forces=("x",), pressure=None)
    done = duhem.project(law, [[2.0], [5.0]], convex="assume")
    assert done.status.tolist() == [status] * 2
    at = [float(law.g.subs(law.force_symbols()[0], float(x))) for x in done.stress[:, 0]]
    assert np.abs(at).max() <= 1e-9 if status == Status.SLIP else np.array_equal(done.stress, [[2.0], [5.0]])
