"""One letter, several ways to write it: names are compared in one normal form, before every check."""

import json

import numpy as np
import pytest

import duhem
from duhem import POSITIVE, Criterion, Domain, InputError
from duhem.expression.syntax import spelled
from duhem.law import criterion_file
from duhem.path import scene_file
from duhem.proof.kernel import certificate as kernel

MICRO, MU = "\u00b5", "\u03bc"  # two letters that look alike: the micro sign, and mu
WIDE = str.maketrans({chr(c): chr(c + 0xFEE0) for c in range(0x21, 0x7F)} | {"_": "_"})


def file(g: str, parameters: str, more: str = "") -> str:
    return f'[criterion]\nname = "x"\ng = "{g}"\n{more}[parameters]\n{parameters}\n'


def test_the_normal_form_is_of_names_alone():
    assert spelled(MICRO) == MU and spelled("pi".translate(WIDE)) == "pi"
    assert spelled("x²") == "x²" and spelled("½") == "½" and spelled(3) == 3  # what is no name is refused as it is written


@pytest.mark.parametrize("word", ["pi", "norm", "max", "lambda", "and"])
def test_a_word_in_wide_letters_is_taken(word):
    name = word.translate(WIDE)
    attempts = (
        lambda: criterion_file.reads(file(f"norm(sigma_a, sigma_b) + {name}*sigma_n", f'"{name}" = {{}}')),
        lambda: Criterion("x", f"norm(sigma_a, sigma_b) + {name}*sigma_n", {name: POSITIVE}),
        lambda: Criterion("x", "norm(sigma_a, sigma_b) + mu*sigma_n", {"mu": POSITIVE}, define={name: "sigma_a"}),
        lambda: Criterion("x", "sigma_a + mu*sigma_n", {"mu": POSITIVE}, forces=("sigma_a", name)),
    )
    for attempt in attempts:
        with pytest.raises(InputError, match="already means something"):
            attempt()


def test_two_spellings_of_a_name_are_one_name():
    both = {MICRO: POSITIVE, MU: POSITIVE}
    with pytest.raises(InputError, match="declared twice"):
        criterion_file.reads(file("norm(sigma_a, sigma_b) + mu*sigma_n", f'"{MICRO}" = {{}}\n"{MU}" = {{}}'))
    with pytest.raises(InputError, match="two spellings"):
        Criterion("x", f"norm(sigma_a, sigma_b) + {MU}*sigma_n", both)
    with pytest.raises(InputError, match="declared twice"):
        Criterion("x", f"norm({MU}, sigma_b) + {MU}*sigma_n", {MICRO: POSITIVE}, forces=(MU, "sigma_b"))
    with pytest.raises(InputError, match="declared twice"):
        Criterion("x", f"norm(sigma_a, sigma_b) + {MU}*sigma_n", {MICRO: POSITIVE}, define={MU: "sigma_a"})
    with pytest.raises(InputError, match="declared twice"):
        criterion_file.reads(
            file(f"norm(sigma_a, sigma_b) + {MU}*sigma_n", f'"{MICRO}" = {{}}').replace(
                "[parameters]", f'[define]\n"{MU}" = "1"\n[parameters]'
            )
        )
    with pytest.raises(InputError, match="two ranges"):
        wide = "sigma_n".translate(WIDE)
        criterion_file.reads(file("abs(sigma_a) + sigma_n", "").replace("[param", f'[domain]\nsigma_n={{}}\n"{wide}"={{}}\n[param'))


@pytest.fixture
def law() -> Criterion:
    return criterion_file.reads(file(f"norm(sigma_a, sigma_b) + {MU}*sigma_n", f'"{MICRO}" = {{ positive = true }}'))


def test_either_spelling_names_the_parameter(law):
    assert tuple(law.parameters) == (MU,)
    trial = np.array([1.0, 1.0])
    first, second = (duhem.project(law, trial, -1.0, 1.0, {name: 0.2}).stress for name in (MU, MICRO))
    assert np.array_equal(first, second)
    assert law.fix({MICRO: "1/5"}) == law.fix({MU: "1/5"})
    for attempt in (law.fix, lambda values: duhem.project(law, trial, -1.0, 1.0, values)):
        with pytest.raises(InputError, match="two spellings"):
            attempt({MU: "1/5", MICRO: "1/4"})
    assert law == Criterion("x", f"norm(sigma_a, sigma_b) + {MICRO}*sigma_n", {MU: POSITIVE})


def test_the_kernel_checks_it(law):
    found = duhem.verify(law, claims=["origin", "convexity"]).certificate()
    rows = kernel.recheck(json.loads(json.dumps(found)))
    assert [r.confirmed for r in rows if r.claim in ("origin", "convexity")] == [True, True]


def test_a_definition_and_a_stress_in_either_spelling():
    text = file(f"{MU}s - 1", '"c" = {}', 'stress = { name = "µ", kind = "principal" }\n').replace(
        "[param", f'[define]\n"{MICRO}s" = "J2 + c**2*{MICRO}_1"\n[param'
    )
    law = criterion_file.reads(text.replace("J2", f"J2({MU})"))
    assert law.forces == (f"{MU}_1", f"{MU}_2", f"{MU}_3") and tuple(law.define) == (f"{MU}s",)


def test_a_scene_and_the_command_take_either_spelling(tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.toml").write_text(file(f"norm(sigma_a, sigma_b) + {MU}*sigma_n", f'"{MICRO}" = {{ positive = true }}'))
    scene = 'law = "law.toml"\nstiffness = 1\n[parameters]\nSET\n[path]\nkind = "linear"\npoints = [[0, 0], [1, 1]]\npressure = -1\n'
    assert len(scene_file.reads(scene.replace("SET", f'"{MU}" = 0.2')).run()) == 2
    with pytest.raises(InputError, match="two spellings"):
        scene_file.reads(scene.replace("SET", f'"{MU}" = 0.2\n"{MICRO}" = 0.2'))
    assert run("verify", "law.toml", "--claims", "origin", "--set", f"{MICRO}=0.2")[0] == 0
    code, _, message = run("verify", "law.toml", "--claims", "origin", "--set", f"{MICRO}=0.2", "--set", f"{MU}=0.3")
    assert code == 2 and "set twice" in message


def test_a_decorated_function_has_its_names_in_the_same_form():
    @duhem.criterion(name="wide-names", parameters={MICRO: Domain.between(0, 1)}, pressure="sigma_n".translate(WIDE))
    def wide(sigma_a, sigma_b, sigma_n, μ):
        return abs(sigma_a) + abs(sigma_b) + μ * sigma_n

    assert wide.parameters[MU] == Domain.between(0, 1) and wide.pressure == "sigma_n"
