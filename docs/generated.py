"""The parts of the pages that are made from the code: `python -m docs.generated` writes them, and a test fails where one has gone stale.

A part stands between the lines `<!-- generated: NAME -->` and `<!-- end of NAME -->`.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from importlib import import_module
from inspect import getdoc
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from duhem.law.atlas.entry import AtlasEntry

SCHEMAS = Path(__file__).parent / "reference"
PAGES = sorted(SCHEMAS.glob("*.md"))

_PLACE = re.compile(r"^<!-- generated: ([a-z-]+) -->\n(?:.*?^<!-- end of \1 -->\n)?", flags=re.M | re.S)


def filled(text: str) -> str:
    """A page with its parts as the code says them now; KeyError for a part that there is not."""
    return _PLACE.sub(lambda match: f"<!-- generated: {match[1]} -->\n\n{PARTS[match[1]]()}\n\n<!-- end of {match[1]} -->\n", text)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    cells = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", r"\|").replace("\n", " ") for cell in row) + " |" for row in cells)


def atlas() -> str:
    """Every published law by group: its verdicts as `duhem atlas` prints them, and what is said of it."""
    from duhem.cli.verbs.atlas import word
    from duhem.law.atlas.entry import ASKED, entries, groups

    parts = []
    for group in groups():
        laws = entries(group)
        rows = ([f"`{law.name}`", *(word(law.verdicts[claim]) for claim in ASKED)] for law in laws)
        parts += [f"## {group}", table(["law", *ASKED], rows), *map(_published, laws)]
    return "\n\n".join(parts)


def _published(law: AtlasEntry) -> str:
    said = "; ".join(f"{claim}: {text}" for claim, text in law.claims.items())
    heard, found = said and f"Said of it: {said}.", law.found and f"Found: {'; '.join(law.found)}."
    parts = (f"{law.summary}.", f"{law.source}.", law.equation and f"{law.equation}.", heard, found, law.note)
    return f"- `{law.name}`: " + " ".join(plain(part) for part in parts if part)


def words() -> str:
    """The words of a formula, from the list that the parser reads."""
    from duhem.expression import WORDS

    def taken(least: int, most: int | None) -> str:
        return f"{least} or more" if most is None else str(least) if least == most else f"{least} to {most}"

    rows = ([f"`{name}`", taken(word.least, word.most), word.meaning] for name, word in WORDS.items())
    return table(["word", "arguments", "meaning"], rows)


def invariants() -> str:
    """What a formula may say of a declared stress."""
    from duhem.expression.abbreviations import INVARIANTS

    return table(["word", "meaning"], ([f"`{name}`", word.meaning] for name, word in INVARIANTS.items()))


def stresses() -> str:
    """The kinds of stress and the forces that a law of each has."""
    from duhem.expression.abbreviations import KINDS, Stress

    rows = ([f"`{kind}`", ", ".join(f"`{force}`" for force in Stress("sigma", kind).components)] for kind in KINDS)
    return table(["kind", 'forces, for `name = "sigma"`'], rows)


def laws() -> str:
    """Each built-in law: what its formula is, in which units, and what holds of it; as its file says."""
    from duhem.law import catalogue

    return "\n\n".join(_law(name) for name in catalogue.names() if catalogue.shipped(name))


def _law(name: str) -> str:
    from duhem.law import catalogue

    law = catalogue.load(name)
    summary, *rest = _paragraphs(catalogue.description(name))
    parameters = ", ".join(f"`{parameter}` {domain.describe()}" for parameter, domain in law.parameters.items())
    return "\n\n".join([f"## {name}", summary, *rest, f"Parameters: {parameters or 'none'}."])


def _paragraphs(text: str) -> Iterator[str]:
    """Those of a docstring, as Markdown: indented ones as code, the others with their signs kept."""
    for paragraph in re.split(r"\n\s*\n", text):
        if paragraph.startswith("- "):
            yield "\n".join("- " + plain(" ".join(item.split())) for item in re.split(r"^- ", paragraph, flags=re.M)[1:])
        elif paragraph.startswith("    "):
            yield "```text\n" + "\n".join(line.removeprefix("    ") for line in paragraph.splitlines()) + "\n```"
        else:
            yield plain(" ".join(paragraph.split()))


def plain(text: str) -> str:
    """Words and formulas as they stand: what Markdown would read as marks is kept from it, outside code."""
    parts = re.split(r"(``.+?``)", re.sub(r":[a-z]+:`~?([^`]+)`", r"``\1``", text))
    return "".join(part[1:-1] if i % 2 else re.sub(r"([\\*_|$<\[\]^~])", r"\\\1", part) for i, part in enumerate(parts))


def claims() -> str:
    """What `duhem explain` says of each claim."""
    from duhem.proof.claims import EVERY

    parts = ([f"## {name}", f"**{plain(claim.statement)}**", *_paragraphs(claim.theory.strip())] for name, claim in EVERY.items())
    return "\n\n".join("\n\n".join(part) for part in parts)


def commands() -> str:
    """Each command with what its help says."""
    from duhem.cli import cli

    whole = click.Context(cli, info_name="duhem", terminal_width=100, **cli.context_settings)
    return "\n\n".join(_command(name, command, whole) for name, command in cli.commands.items())


def _command(name: str, command: click.Command, whole: click.Context) -> str:
    context = click.Context(command, parent=whole, info_name=name)
    return f"## duhem {name}\n\n```text\n{command.get_help(context)}\n```"


def scene() -> str:
    """The keys of a scene by section, and those of each kind of path, from the table that the reader reads."""
    from duhem.path.scene_file import CHOICES, KIND_KEYS, KINDS, SECTIONS

    def row(key: str, means: str) -> list[str]:
        words = ", ".join(f"`{word}`" for word in CHOICES.get(key, ()))
        return [f"`{key}`", f"{plain(means)} ({words})" if words else plain(means)]

    def of_kind(kind: str, key: str) -> list[str]:
        return row(key, KIND_KEYS.get(f"{kind} {key}", "") or KIND_KEYS[key])

    parts = []
    for section, keys in SECTIONS.items():
        title = f"`[{section}]`" if section else "Above the first section"
        parts += [f"## {title}", table(["key", "says"], (row(key, means) for key, means in keys.items()))]
    parts += ["## `[path]`", "`kind` is one of the following; each has keys of its own."]
    for kind, (means, needs, may) in KINDS.items():
        rows = [of_kind(kind, key) for key in (*needs, *may, "pressure")]
        needed = ", ".join(f"`{key}`" for key in needs)
        parts += [f'### kind = "{kind}"', f"{plain(means).capitalize()}. Needed: {needed}.", table(["key", "says"], rows)]
    return "\n\n".join(parts)


def campaign() -> str:
    """The keys of a campaign, as the module that reads them says."""
    from duhem.screening import file

    return f"```toml\n{(getdoc(file) or '').split(chr(10) * 2, 1)[1]}\n```"


def exit_codes() -> str:
    """The exit codes, each with its meaning."""
    from duhem.cli.output import MEANINGS

    rows = ([str(code), plain(MEANINGS[code])] for code in sorted(MEANINGS))
    return table(["code", "meaning"], rows)


def verdicts() -> str:
    """The words of a verdict and of a trust, as their module says them."""
    from duhem.proof import verdict

    words = _paragraphs((verdict.__doc__ or "").split("\n\n", 1)[1])
    trusts = _paragraphs(getdoc(verdict.Trust) or "")
    return "\n\n".join([*words, *trusts])


def json_keys() -> str:
    """Each schema beside the reference as a table of its keys."""
    schemas = (json.loads(file.read_text("utf-8")) for file in sorted(SCHEMAS.glob("*.schema.json")))
    return "\n\n".join(f"## {s['title']}\n\n{s['description']}\n\n{table(['key', 'is', 'means'], _keys(s, s))}" for s in schemas)


def _keys(schema: Mapping[str, Any], whole: Mapping[str, Any], before: str = "") -> Iterator[list[str]]:
    """The keys of an object, and of those in it, with a dot between."""
    needed = schema.get("required", ())
    for key, value in schema.get("properties", {}).items():
        value = _resolved(value, whole)
        name = f"{before}{key}"
        yield [f"`{name}`" + ("" if key in needed else " (optional)"), _type(value), plain(value.get("description", ""))]
        yield from _keys(value, whole, f"{name}.")
        yield from _keys(_resolved(value.get("items", {}), whole), whole, f"{name}[].")


def _resolved(schema: Mapping[str, Any], whole: Mapping[str, Any]) -> Mapping[str, Any]:
    """A schema, or the one in $defs that it refers to, with what it says itself."""
    refers = schema.get("$ref")
    return schema if refers is None else whole["$defs"][refers.rsplit("/", 1)[1]] | {k: v for k, v in schema.items() if k != "$ref"}


def _type(schema: Mapping[str, Any]) -> str:
    if "const" in schema or "enum" in schema:
        return ", ".join(f"`{json.dumps(word)}`" for word in schema.get("enum", [schema.get("const")]))
    given = schema.get("type", "any")
    return " or ".join([given] if isinstance(given, str) else given)


def python() -> str:
    """What each name that a program imports is, in the order of its module."""
    known: set[object] = set()
    return "\n\n".join(_module(name, known) for name in ("duhem", "duhem.testing", "duhem.testing.foreign"))


def _module(name: str, known: set[object]) -> str:
    """The names of a module that are not ``known`` yet from another."""
    module = import_module(name)
    parts = [f"## {name}", *_paragraphs(getdoc(module) or "")]
    for each in module.__all__:
        value = getattr(module, each)
        if (inspect.isclass(value) or inspect.isfunction(value)) and value not in known:
            known.add(value)
            parts += _documented(f"### {each}", each, value)
            parts += _members(each, value) if inspect.isclass(value) and not issubclass(value, Enum) else ()
    return "\n\n".join(parts)


def _documented(title: str, called: str, value: Any) -> list[str]:
    """A title, how the value is called (without annotations, which the docstring says better), and its docstring."""
    parts = [title] if title else []
    if callable(value) and not (inspect.isclass(value) and issubclass(value, Enum)):
        signature = inspect.signature(value)
        free = [parameter.replace(annotation=parameter.empty) for parameter in signature.parameters.values()]
        shown = re.sub(r"<function \S+ at 0x\w+>", "...", str(signature.replace(parameters=free, return_annotation=signature.empty)))
        parts.append(f"```text\n{called}{shown}\n```")
    return parts + list(_paragraphs(getdoc(value) or ""))


def _members(of: str, value: type) -> Iterator[str]:
    """The methods and properties that a class documents, its own and those of its room that it inherits."""
    room = value.__module__.rpartition(".")[0]
    own = [base for base in value.__mro__ if base.__module__.rpartition(".")[0] == room]
    for name, member in (item for base in own for item in vars(base).items()):
        inner = getattr(member, "__func__", getattr(member, "fget", member))  # of a class method or a property
        if not name.startswith("_") and inspect.isfunction(inner) and inner.__doc__:
            yield from _documented(f"#### {of}.{name}", f"{of}.{name}", member if isinstance(member, property) else getattr(value, name))


PARTS = {
    "atlas": atlas,
    "campaign": campaign,
    "claims": claims,
    "commands": commands,
    "exit-codes": exit_codes,
    "invariants": invariants,
    "json": json_keys,
    "laws": laws,
    "python": python,
    "scene": scene,
    "stresses": stresses,
    "verdicts": verdicts,
    "words": words,
}


if __name__ == "__main__":
    for page in PAGES:
        page.write_text(filled(page.read_text("utf-8")), "utf-8")
