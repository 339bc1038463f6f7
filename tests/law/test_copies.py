"""A law, and what follows from it, is a value: pickled or copied it equals itself, and says the same."""

import copy
import operator
import pickle
import textwrap
from dataclasses import replace

import pytest
import sympy as sp

import duhem
from duhem.law import catalogue
from duhem.law.domain import Domain, Domains
from tests.long import long_but

FILE = """\
[criterion]
name = "from-file"
g = "norm((sigma_a - shift*abs(sigma_n))/mu_a, where(sigma_b > 0, sigma_b/mu_b, sigma_b)) - abs(sigma_n)"
constraints = ["shift < mu_a"]

[parameters]
mu_a = { positive = true }
mu_b = { value = 0.15 }
shift = { min = 0, max = 0.5 }

[flow]
direction = ["sigma_a", "sigma_b**3.0012"]
"""


def pickled(value):
    return pickle.loads(pickle.dumps(value))


def expressions(law):
    """Everything symbolic in a law, written out."""
    parts = [*getattr(law, "boundary", ()), *([law.g] if hasattr(law, "g") else []), *law.constraints, *(law.flow or ())]
    return [sp.srepr(part) for part in parts] + [repr(getattr(law, "closed_form", None))]


def test_the_hash_a_law_keeps_is_not_handed_to_another_process():
    law = duhem.load("coulomb")
    assert hash(law) == hash(law) and "_hash" in vars(law)
    assert "_hash" not in law.__getstate__() and hash(pickled(law)) == hash(law)


@pytest.mark.slow
@pytest.mark.parametrize("copied", [pickled, copy.deepcopy], ids=["pickle", "deepcopy"])
@pytest.mark.parametrize("name", catalogue.names())
def test_every_law_equals_its_copies(name, copied):
    law = catalogue.load(name)
    for each in (law, law.fix({p: "0.25" for p, d in law.parameters.items() if sp.Rational(1, 4) in d})):
        back = copied(each)
        assert back == each and hash(back) == hash(each) and expressions(back) == expressions(each)
        assert back.symbols() == each.symbols() and list(back.symbols()) == list(each.symbols())
        assert list(back.parameters.items()) == list(each.parameters.items())
        if isinstance(each, duhem.Criterion):
            assert back.settled() == each.settled()


def test_a_law_from_a_file_equals_its_copies(tmp_path):
    (tmp_path / "law.toml").write_text(textwrap.dedent(FILE))
    law = duhem.load(tmp_path / "law.toml")
    for back in (pickled(law), copy.deepcopy(law)):
        assert back == law and hash(back) == hash(law) and expressions(back) == expressions(law)


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([2], ["antoni2007", "box", "rotated-flow", "limacon", "wedge"]))
def test_a_derivation_equals_its_copies_and_reads_the_same(name):
    derivation = duhem.derive(name)
    for back in (pickled(derivation), copy.deepcopy(derivation)):
        assert back == derivation and [hash(e) for e in back] == [hash(e) for e in derivation]
        assert back.text() == derivation.text() and back.latex() == derivation.latex() and back.markdown() == derivation.markdown()
        assert [sp.srepr(e.relation) for e in back] == [sp.srepr(e.relation) for e in derivation]


def test_definitions_are_copied_with_all_that_they_stand_for():
    law = duhem.Criterion("x", "p - k", {"m": duhem.POSITIVE}, define={"k": "2*m", "p": "norm(sigma_a, sigma_b) - k"})
    for back in (pickled(law), copy.copy(law), copy.deepcopy(law), replace(law)):
        assert back == law and back.define == law.define and back.define.short == law.define.short and back.defined() == law.defined()


def test_the_domains_of_a_law_cannot_be_changed():
    law = duhem.load("coulomb")
    before, one = dict(law.parameters), {"mu": Domain()}
    for change in (
        lambda own: operator.setitem(own, "mu", Domain()), lambda own: operator.delitem(own, "mu"), lambda own: own.update(one),
        lambda own: own.setdefault("nu", Domain()), lambda own: own.pop("mu"), lambda own: own.popitem(), lambda own: own.clear(),
    ):  # fmt: skip
        with pytest.raises(TypeError, match="Domains"):
            change(law.parameters)
    own = law.parameters
    for made in (own | one, one | own, operator.ior(own, one), own.copy()):
        assert type(made) is dict and made.keys() == own.keys()
    assert law.parameters is own and own == before
    with pytest.raises(AttributeError):
        law.parameters = {}
    given = {"mu": Domain.between(0, 1)}
    domains = Domains(given)
    given["mu"] = Domain()
    assert domains["mu"] == Domain.between(0, 1) and domains == {"mu": Domain.between(0, 1)}
    assert domains == pickled(domains) and hash(domains) == hash(pickled(domains))
