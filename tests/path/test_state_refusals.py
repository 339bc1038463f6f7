"""What is not answered along paths of laws with a state, what must not pass for an answer, and what is asked in vain."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, InputError, Path, Paths, Status, YieldSurface
from duhem.expression.numpy_ import compiled
from duhem.law.state import Variable
from duhem.path import state_step
from duhem.path.history import LeftDomain
from duhem.path.state_path import NoAnswer
from tests.path.states import BACK, FREDERICK, ONE, PRAGER, QUADRATIC, RECOVERING, SLIP, STORED, H, made, plane, run


def test_a_step_without_an_answer_ends_the_path_and_never_passes_for_one() -> None:
    """More softening than elasticity: beyond the peak no state satisfies the conditions."""
    softening = made("abs(sigma) + A - R", f"{QUADRATIC} - H*alpha**2", SLIP | {"alpha": Variable("A")}, names=("H",))
    with pytest.raises(NoAnswer, match="has no answer") as fault:
        run(softening, Path.linear([0.0, 0.005, 0.1]), parameters=ONE | {"H": 80.0})
    assert len(fault.value.history) == 2 and fault.value.history["sigma"][-1] == pytest.approx(0.5)
    many = run(softening, Paths.linear([[0.0, 0.005, 0.1], [0.0, 0.005, 0.006]]), parameters=ONE | {"H": 80.0})
    assert many.status.tolist() == [Status.FAILED, Status.STICK] and many.reached.tolist() == [1, 2]
    assert np.isnan(many.state[0, 2]).all()


def test_a_force_that_leaves_its_range_ends_the_path() -> None:
    law = made("norm(sigma + X) - R", STORED, BACK, names=("C",), domain={"sigma": Domain.between(-2, 2)})
    with pytest.raises(LeftDomain, match=r"sigma = .* lies outside its range") as fault:
        run(law, parameters=ONE | {"C": 10.0}, substeps=10)
    assert abs(fault.value.history["sigma"][-1]) <= 2.0


@pytest.mark.parametrize("g", ["abs(sa) - sqrt(1 - sb)", "abs(sa) - (1 - sb)**(3/4)", "log(1 + sb) + abs(sa) - 1"])
def test_a_criterion_without_a_value_is_not_satisfied(g: str) -> None:
    for end in ((0.5, 3.0), (0.0, -9.0), (0.0, 3.0)):
        with suppress(NoAnswer):
            history = duhem.simulate(plane(g), Path.linear([[0.0, 0.0], end]))
            values = compiled(plane(g).g, plane(g).force_symbols())(*history.force.T)
            assert (values <= 1e-9).all()


def test_a_slope_without_end_hides_no_other_surface() -> None:
    law = plane(sp.nan, surfaces=(YieldSurface("sqrt(abs(sa)) - 1"), YieldSurface("abs(sb) - 1")))
    history = duhem.simulate(law, Path.linear([[0.0, 0.0], [0.0, 3.0], [0.0, 50.0]]))
    assert history.force[1:].tolist() == [[0.0, 1.0], [0.0, 1.0]]
    with pytest.raises(InputError, match="outside K"):
        duhem.simulate(law, Path.linear([[0.0, 50.0], [0.0, 51.0]]))


@pytest.mark.parametrize(("n", "k", "dt"), [("3/10", "1000000", 1.0), ("3/10", "100", 1e3), ("1/2", "10000", 1e3)])
def test_a_steep_viscous_flow_is_right_or_no_answer(n: str, k: str, dt: float) -> None:
    """eta rate = (|s| - 1)^n beyond the threshold: a step at dt -> oo ends at |s| = 1 with the sign of the load."""
    variables = {"u": Variable("s", observable=True), "p": Variable("s")}
    potential, energy = f"1/({n} + 1)*max(abs(s) - 1, 0)**({n} + 1)", f"{k}/2*(u - p)**2"
    law = Criterion("steep", potential, {}, ("s",), None, energy=energy, variables=variables, viscous=True)
    knots, wanted = [0.0, 9.0, 120.0, -50.0], [0.0, 1.0, 1.0, -1.0]
    try:
        found = duhem.simulate(law, Path.linear(knots, time=[dt * i for i in range(4)])).force[:, 0]
    except NoAnswer as fault:
        found = fault.history.force[:, 0]
    assert all(s * w >= 0.0 for s, w in zip(found, wanted, strict=False))


def test_a_criterion_that_is_violated_where_its_slope_has_no_end_is_not_satisfied() -> None:
    assert state_step._excess(np.array([2.0, 2.0, np.nan, -1.0, 0.0]), np.array([np.inf, 4.0, 1.0, np.inf, 0.0])).tolist() == [
        np.inf, 0.5, np.inf, 0.0, 0.0,
    ]  # fmt: skip


def test_what_a_path_without_an_answer_says() -> None:
    history = run(PRAGER, parameters=ONE | {"C": H})
    for residual, said in ((np.inf, "no value"), (0.2, "met to 0.2 and not to 1e-10"), (3e-12, "hold to 3e-12")):
        assert said in str(NoAnswer(history, 1.0, residual))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"method": "exact"}, "no method 'exact'"),
        ({"stiffness": 1.0}, "has an energy"),
        ({"stress": [1.0, 0.0]}, "the start of made is a state"),
        ({"state": {"alpha": 3.0}}, "lie outside K"),
        ({"state": {"u": 0.0}}, "'u' is not a variable that begins somewhere"),
        ({"state": {"alpha": [0.0, 1.0]}}, "one a point"),
        ({"parameters": ONE | {"C": 1.0}}, "no value is given for gamma"),
        ({"parameters": ONE | {"C": -1.0, "gamma": 1.0}}, "C = -1"),
        ({"parameters": ONE | {"C": 1.0, "gamma": 1.0, "alpha": 0.0}}, "alpha is a variable"),
        ({"path": Path.linear([[0, 0], [1, 1]])}, "2 columns"),
        ({"path": Path.linear([0, 1], pressure=-1.0)}, "has no pressure"),
        ({"law": RECOVERING}, "the path states no times"),
        ({"law": made("norm(sigma + X) - R", None, BACK), "stiffness": 1.0}, "nothing says how the force X follows from alpha"),
        ({"convex": "require"}, "not required of made"),
        ({"keep": 2}, "only to many points"),
        ({"tangent": True, "path": Path.linear([0.0, 0.5], control="stress")}, "no displacement"),
        ({"law": "mohr-coulomb", "state": {"alpha": 1.0}}, "has no state"),
    ],
)
def test_misuse_is_named(change: dict[str, Any], message: str) -> None:
    asked = {"law": FREDERICK, "path": Path.linear([0.0, 1.0]), "parameters": ONE | {"C": 1.0, "gamma": 1.0}} | change
    with pytest.raises(InputError, match=message):
        duhem.simulate(asked.pop("law"), asked.pop("path"), **asked)


def test_a_tangent_is_one_of_the_step() -> None:
    with pytest.raises(InputError, match="no tangent"):
        duhem.simulate(plane("norm(sa, sb) - 1"), Path.linear([[0.0, 0.0], [3.0, 0.0]]), method="extrapolated", tangent=True)


def test_a_state_is_a_mapping() -> None:
    with pytest.raises(InputError, match="no mapping"):
        duhem.simulate(plane("norm(sa, sb) - 1"), Path.linear([[0.0, 0.0], [3.0, 0.0]]), state=[1, 2])
