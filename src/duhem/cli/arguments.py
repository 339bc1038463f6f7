"""What the commands read: a law, its parameters, numbers.  An error names the option and the remedy."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar, cast

import click
from click.shell_completion import CompletionItem

from duhem.errors import DuhemError, InputError, faults_at, meant
from duhem.law.convex import CONVEX

if TYPE_CHECKING:
    from sympy import Rational

    from duhem.law.curve_law import Law
    from duhem.law.formula_law import Criterion

_Command = TypeVar("_Command", bound=Callable[..., Any])

__all__ = [
    "Vectors",
    "check_names",
    "choice_option",
    "complete_claims",
    "complete_expected",
    "complete_law",
    "convex_option",
    "flagship_argument",
    "format_option",
    "group_option",
    "json_option",
    "law_argument",
    "laws_argument",
    "modules_beside_the_user",
    "peers_option",
    "read_attribute",
    "read_claims",
    "read_fixed_formula",
    "read_fixed_law",
    "read_law",
    "read_number",
    "read_numbers",
    "read_pair",
    "read_routine",
    "read_settings",
    "read_subject",
    "report_format_option",
    "settings_option",
    "stiffness_option",
]


def complete_law(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    from itertools import chain

    from duhem.law import catalogue
    from duhem.law.atlas.entry import groups

    every = chain(catalogue.names(), *groups().values())
    named = [CompletionItem(name) for name in every if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


def complete_claims(_: click.Context, __: click.Parameter, incomplete: str) -> list[str]:
    """The claims that may follow in a list with commas."""
    from duhem.proof.kernel.certificate import CLAIMS

    before, comma, last = incomplete.rpartition(",")
    return [f"{before}{comma}{name}" for name in CLAIMS if name.startswith(last) and name not in before.split(",")]


def complete_expected(_: click.Context, __: click.Parameter, incomplete: str) -> list[str]:
    """CLAIM=VERDICT: the claims first, then the verdicts."""
    from duhem.proof.kernel.certificate import CLAIMS, VERDICTS

    claim, equals, _verdict = incomplete.partition("=")
    every = [f"{claim}={verdict}" for verdict in VERDICTS] if equals else [f"{name}=" for name in CLAIMS]
    return [each for each in every if each.startswith(incomplete)]


def _complete_setting(context: click.Context, _: click.Parameter, incomplete: str) -> list[str]:
    """The parameters of the law that the line names before; what is no law, or would import a module, has none."""
    named = [context.params.get(key) for key in ("law", "laws", "subject")]
    given = next(filter(None, [*named, context.args, [""]]))  # an option without its value leaves arguments where they are
    law = given if isinstance(given, str) else given[0]
    try:
        known = read_law(law).parameters if ":" not in law else ()
    except DuhemError:
        known = ()
    return [f"{name}=" for name in known if name.startswith(incomplete)]


law_argument = click.argument("law", shell_complete=complete_law)
laws_argument = click.argument("laws", nargs=-1, required=True, metavar="LAW...", shell_complete=complete_law)
group_option = click.option("--group", metavar="GROUP", help="Show only this group of the atlas, for example metals.")
settings_option = click.option(
    "--set",
    "settings",
    metavar="NAME=VALUE",
    multiple=True,
    shell_complete=_complete_setting,
    help="Fix a parameter at an exact value, for example mu_a=0.15 or mu_a=3/20. Repeatable.",
)


def choice_option(*names: str, of: Sequence[str], says: str, default: str = "") -> Callable[[_Command], _Command]:
    """One ``of`` several words, the ``default`` or the first of them where it is left out."""
    return click.option(*names, type=click.Choice(of), default=default or of[0], show_default=True, help=says)


def format_option(*forms: str, says: str = "How to print it.") -> Callable[[_Command], _Command]:
    """``--format``, one of ``forms``, the first of them where it is left out."""
    return choice_option("--format", "form", of=forms, says=says)


report_format_option = format_option(
    "text", "json", "junit", says="The form of the output: text for people, JSON for programs, or JUnit XML for integration servers."
)


def convex_option(says: str) -> Callable[[_Command], _Command]:
    """``--convex``, which ``says`` what is asked of K."""
    return choice_option("--convex", of=CONVEX, says=says)


def read_law(text: str) -> Law:
    from duhem.law import catalogue

    with modules_beside_the_user(text):
        return cast("Law", catalogue.load(text))


def read_attribute(text: str) -> object:
    """What ``module:attribute`` names, whatever it is."""
    from duhem.law import catalogue

    with modules_beside_the_user(text):
        return catalogue.attribute(text, text)


def read_routine(text: str) -> Any:
    """The routine ``module:callable``, or the material of that name; InputError for anything else."""
    from duhem.testing.routines import Material

    found = read_attribute(text)
    if not callable(found) and not isinstance(found, Material):
        raise InputError(
            f"{text[:60]} is a {type(found).__name__}, not a routine", remedy="name a function update(trial, pressure, stiffness)"
        )
    return found


@contextmanager
def modules_beside_the_user(text: str) -> Iterator[None]:
    """The working folder on the path for ``module:attribute``, after all that is installed: no file stands in for a part of Python."""
    if ":" not in text or "" in sys.path:
        yield
        return
    sys.path.append("")
    try:
        yield
    finally:
        sys.path.remove("")


def read_fixed_formula(text: str, settings: Sequence[str]) -> Criterion:
    """A law that has a formula g; an error names one to take where it has none."""
    from duhem.law import catalogue

    catalogue.load_formula(read_law(text))
    return catalogue.load_formula(read_fixed_law(text, settings))


def read_pair(text: str, where: str, form: str, example: str) -> tuple[str, str]:
    """The two sides of an option such as NAME=VALUE."""
    left, equals, right = (part.strip() for part in text.partition("="))
    if not (left and equals and right):
        raise InputError(f"this is not of the form {form}", where=where, remedy=f"write for example {example}")
    return left, right


def read_settings(settings: Sequence[str], law: Law | None = None) -> dict[str, Rational]:
    """The values of ``--set``, exactly, and as ``law`` admits them."""
    from duhem.expression.number import exact_number
    from duhem.expression.syntax import spelled

    values: dict[str, Rational] = {}
    for setting in settings:
        where = f"--set {setting}"
        name, value = read_pair(setting, where, "NAME=VALUE", "--set mu_a=0.15")
        if (name := spelled(name)) in values:
            raise InputError(f"{name} is set twice", where=where, remedy="set it once")
        with faults_at(where):
            values[name] = exact_number(value)
            if law is not None:
                law.fix({name: values[name]})
    return values


def read_fixed_law(text: str, settings: Sequence[str]) -> Law:
    law = read_law(text)
    from duhem.law.parameter_domain import check_domain

    fixed = law.fix(read_settings(settings, law))
    check_domain(fixed, where=" ".join(f"--set {setting}" for setting in settings))
    return fixed


def read_claims(text: str) -> tuple[str, ...]:
    """Names of claims, each once, from a list with commas."""
    from duhem.proof.claims import CLAIMS

    asked = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    check_names("claim", asked, CLAIMS, "claims are")
    if not asked:
        raise InputError("no claim is named", where="--claims", remedy=f"claims are: {', '.join(CLAIMS)}")
    return asked


def check_names(kind: str, names: Iterable[str], known: Iterable[str], choice: str, where: str = "") -> None:
    """Raises InputError for the first name that is not known, with the nearest that is, or all of them."""
    every = tuple(known)
    for name in names:
        if name not in every:
            raise InputError(f"unknown {kind} {name!r}", where=where, remedy=meant(name, every, f"{choice}: {', '.join(every)}"))


def _is_number(text: str) -> bool:
    from duhem.expression.number import exact_number

    try:
        exact_number(text)
    except InputError:
        return text.lower().lstrip("+-") in ("nan", "inf", "infinity")  # numbers, though not usable ones
    return True


def read_numbers(text: str, where: str) -> list[float]:
    from duhem.expression.number import exact_number

    with faults_at(where):
        return [float(exact_number(word)) for word in text.replace(",", " ").split()] or [float(exact_number(text))]


def read_number(text: str, where: str) -> float:
    numbers = read_numbers(text, where)
    if len(numbers) > 1:
        raise InputError(f"this option has {len(numbers)} numbers", where=where, remedy="give one")
    return numbers[0]


class Vectors(click.Command):
    """A command whose options named in ``vectors`` take all the numbers that follow, signs included."""

    vectors = ("--trial", "--stiffness")

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        joined: list[str] = []
        for arg in args:
            open_ = bool(joined) and (joined[-1] in self.vectors or joined[-1].startswith(tuple(f"{v}=" for v in self.vectors)))
            if open_ and _is_number(arg):
                joined[-1] += f"{' ' if '=' in joined[-1] else '='}{arg}"
            else:
                joined.append(arg)
        return super().parse_args(ctx, joined)


# -- a law and the numbers it is measured at ---------------------------------------------------------------------------

FLAGSHIP = "antoni2007"
FIGURE_5 = {"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"}  # Antoni et al. 2007

flagship_argument = click.argument("law", default=FLAGSHIP, shell_complete=complete_law)
stiffness_option = click.option(
    "--stiffness", metavar="K ...", help="Diagonal stiffness in quotes, one number per force (default: 1 2 ...)."
)
json_option = click.option("--json", "json_file", metavar="FILE", help="Write all results to this file as one JSON object.")
peers_option = click.option(
    "--peers", is_flag=True, help="Also measure the other programs that are installed (SciPy, jaxmat, qpax, ProxQP)."
)


def read_subject(law: str, settings: Sequence[str], stiffness: str | None) -> tuple[Criterion, list[float] | None]:
    """The law, with those of Figure 5 for the parameters of the flagship that are left open, and the diagonal stiffness."""
    if law == FLAGSHIP:
        given = {setting.partition("=")[0].strip() for setting in settings}
        settings = [*settings, *(f"{name}={value}" for name, value in FIGURE_5.items() if name not in given)]
    return read_fixed_formula(law, settings), None if stiffness is None else read_numbers(stiffness, "--stiffness")
