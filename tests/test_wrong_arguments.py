"""Wrong arguments from Python: one InputError that names what, and the remedy; never what Python happens to trip over."""

import pytest

import duhem
from duhem import Criterion, InputError, Path

MU = {"mu": 0.2}
LINE = Path.linear([[0, 0], [1, 1]], pressure=-1.0)
HUGE = 16**4000


def project(**more):
    return duhem.project(**({"law": "coulomb", "trial": [1.0, 1.0], "pressure": -1.0, "parameters": MU} | more))


def simulate(**more):
    return duhem.simulate(**({"law": "coulomb", "path": LINE, "stiffness": 1.0, "parameters": MU} | more))


@pytest.fixture(scope="module")
def verified():
    return duhem.verify("coulomb", claims=["origin", "convexity"])


CASES = {
    "a number for parameters": (lambda: project(parameters=0.2), "map each name to a value"),
    "a list for parameters": (lambda: project(parameters=[0.2]), "map each name to a value"),
    "a text for parameters": (lambda: duhem.verify("coulomb", "mu=0.2"), "map each name to a value"),
    "an unknown parameter": (lambda: project(parameters={1: 0.2}), "unknown parameter 1"),
    "a parameter too long to print": (lambda: project(parameters={"mu": HUGE}), "too long or too large"),
    "a value for a domain": (lambda: Criterion("x", "abs(sigma_a) + mu*sigma_n", parameters={"mu": 0.2}), "write Domain.fixed"),
    "a value for a domain of a function": (
        lambda: duhem.criterion(parameters={"mu": 0.2})(lambda sigma_a, sigma_b, sigma_n, mu: sigma_a + mu * sigma_n),
        "write Domain.fixed",
    ),
    "a list for a path": (lambda: simulate(path=[[0, 0], [1, 1]]), "make one with Path.linear"),
    "a file for a path": (lambda: simulate(path="t.csv"), "Path.from_csv"),
    "no path": (lambda: simulate(path=None), "NoneType is no loading path"),
    "a list for a method": (lambda: simulate(method=["exact"]), "choose implicit"),
    "a table for a start": (lambda: simulate(start={}), "dict is not a history"),
    "a number for a function": (lambda: simulate(on_step=5), "give a function"),
    "a number for claims": (lambda: duhem.verify("coulomb", claims=5), "the claims are: origin"),
    "numbers for claims": (lambda: duhem.verify("coulomb", claims=[1]), "the claims are: origin"),
    "nearly a claim": (lambda: duhem.verify("coulomb", claims="convex"), "did you mean 'convexity'"),
    "a list for an effort": (lambda: duhem.verify("coulomb", effort=[]), "one of: quick"),
    "a number for a group of the atlas": (lambda: duhem.atlas(5), "int is no name of a group"),
    "a list for a group of the atlas": (lambda: duhem.atlas(["friction"]), "list is no name of a group"),
    "bytes for a law": (lambda: duhem.load(b"coulomb"), "bytes is no law"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_wrong_argument_is_one_error_with_a_remedy(case):
    attempt, words = CASES[case]
    with pytest.raises(InputError) as fault:
        attempt()
    assert words in str(fault.value) and fault.value.remedy and "\n" not in str(fault.value)


@pytest.mark.parametrize(
    ("claim", "words"),
    [
        ("convex", "did you mean 'convexity'?"),
        ("normality", "was not selected"),
        (0, "the selected claims are: origin, convexity"),
        ("zz", "the selected claims are"),
    ],
)
def test_a_claim_that_is_not_there(verified, claim, words):
    with pytest.raises(InputError) as fault:
        verified[claim]
    assert words in str(fault.value) and fault.value.remedy


def test_one_claim_is_a_text(verified):
    assert [r.claim for r in duhem.verify("coulomb", claims="origin").results] == ["origin"]
    assert verified["origin"].claim == "origin"
