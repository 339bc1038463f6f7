"""What a verification hands out cannot be changed, and goes through pickle and copy as it is."""

from __future__ import annotations

import copy
import json
import pickle
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from types import MappingProxyType
from typing import Any

import pytest

from duhem import Verdict, Verification, verify
from duhem.law.frozen_mapping import FrozenMapping
from duhem.proof.verdict import Evidence, Witness

WITNESS = Witness({"mu": "3/10"}, {"p": {"sigma_a": "1"}}, {"g(p)": ("-1", "0")}, "made up", {"degrees": 1.5})


@pytest.fixture(scope="module")
def refuted() -> Verification:
    return verify("radial-flow", claims=["normality", "state_laws"])


@pytest.mark.parametrize("again", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy, copy.copy], ids=["pickle", "deepcopy", "copy"])
def test_values_are_the_same_after_a_copy(again, refuted: Verification) -> None:
    assert refuted["normality"].witness is not None
    values = [WITNESS, Evidence(Verdict.REFUTED, "by hand", "made up", WITNESS), *refuted.results, refuted]
    for value in values:
        found = again(value)
        assert type(found) is type(value) and found == value and hash(found) == hash(value) and repr(found) == repr(value)
    assert json.dumps(again(refuted).to_dict()) == json.dumps(refuted.to_dict())


def test_values_do_not_change(refuted: Verification) -> None:
    given = {"sigma_a": "1"}
    witness = Witness({}, {"p": given}, {}, "made up")
    given["sigma_a"] = "2"
    assert witness.points["p"]["sigma_a"] == "1"
    with pytest.raises(TypeError):
        witness.points["p"]["sigma_a"] = "2"  # type: ignore[index]
    for value, name in ((WITNESS, "statement"), (refuted, "results"), (refuted["normality"], "verdict")):
        with pytest.raises(FrozenInstanceError):
            setattr(value, name, None)


def test_a_frozen_mapping_is_a_mapping_with_a_hash() -> None:
    one, two = FrozenMapping({"a": 1, "b": 2}), FrozenMapping({"b": 2, "a": 1})
    assert one == two == {"a": 1, "b": 2} and hash(one) == hash(two) and list(two) == ["b", "a"]
    assert one != FrozenMapping({"a": 1}) and repr(one) == "{'a': 1, 'b': 2}"


@pytest.mark.parametrize("content", [{}, {"b": 2, "a": 1}, {"a": 1, "c": 3}], ids=str)
@pytest.mark.parametrize("build", [dict, OrderedDict, MappingProxyType, FrozenMapping], ids=lambda kind: kind.__name__)
def test_a_frozen_mapping_does_what_a_mapping_proxy_does(content: dict[str, int], build: Callable[[dict[str, int]], Any]) -> None:
    frozen, proxy, other = FrozenMapping(content), MappingProxyType(content), build({"a": 9, "z": 0})
    like = MappingProxyType(dict(other)) if isinstance(other, FrozenMapping) else other
    for got, expected in ((frozen | other, proxy | like), (other | frozen, like | proxy), (frozen.copy(), proxy.copy())):
        assert type(got) is type(expected) and list(got.items()) == list(expected.items())
    assert list(reversed(frozen)) == list(reversed(proxy))
    got = frozen.copy()
    got["new"] = 1
    assert "new" not in frozen
    for nothing in (5, None, [("a", 1)]):
        with pytest.raises(TypeError):
            frozen | nothing
        with pytest.raises(TypeError):
            nothing | frozen
    missing = {name for name in dir(proxy) if not name.startswith("_")} - set(dir(frozen))
    assert not missing
