"""Where things stand in a TOML file: against a writer that knows where it put them, and in texts made to mislead."""

import random
import tomllib

import pytest

from duhem.errors import InputError, meant
from duhem.law.placed_toml import parsed, text_of


def places(document, path=()):
    """Every path of a document."""
    entries = document.items() if isinstance(document, dict) else enumerate(document) if isinstance(document, list) else ()
    for key, value in entries:
        yield (*path, key)
        yield from places(value, (*path, key))


def offset(text, place):
    """The offset that a place file:line:column names, lines counted as an editor does."""
    _, line, column = place.rsplit(":", 2)
    return sum(len(each) + 1 for each in text.split("\n")[: int(line) - 1]) + int(column) - 1


# -- texts made to mislead ----------------------------------------------------------------------------------------

MISLEADING = {
    "key in a comment": ("# a = 1\na = 2", ("a",), "2:1"),
    "key behind a comment": ("b = 1 # a = 1\na = 2", ("a",), "2:1"),
    "key in a string": ('b = "a = 1"\na = 2', ("a",), "2:1"),
    "key in lines of text": ('b = """\na = 1\n[a]\n"""\na = 2', ("a",), "5:1"),
    "key in literal lines": ("b = '''\na = 1\n'''\na = 2", ("a",), "4:1"),
    "quotes at the end of lines of text": ('b = """x\n""a""\na = 1"""""\na = 2', ("a",), "4:1"),
    "escaped quotes": ('b = "\\"\\\\"\nc = """\\"""\\"""" # "\na = 2', ("a",), "3:1"),
    "section in a string": ("b = '[s]'\n[s]\na = 1", ("s",), "2:1"),
    "bracket in an array": ('b = ["]", # ]\n "[s]",\n[1]]\n[s]\na = 1', ("s", "a"), "5:1"),
    "same key elsewhere": ("[t]\na = 1\n[s]\na = 2", ("s", "a"), "4:1"),
    "same key in an inline table": ("b = { a = 1 }\na = 2", ("a",), "2:1"),
    "in an inline table": ("b = { c = [{ a = 1 }, { x = 0, a = 2 }] }", ("b", "c", 1, "a"), "1:32"),
    "in an array of tables": ("[[s]]\na = 1\n[[s]]\na = 2\n[s.t]\na = 3", ("s", 1, "t", "a"), "6:1"),
    "the second of an array of tables": ("[[s]]\na = 1\n[[s]]\na = 2", ("s", 1), "3:1"),
    "nested arrays of tables": ("[[s]]\n[[s.t]]\n[[s]]\n[[s.t]]\n[[s.t]]\na = 1", ("s", 1, "t", 1, "a"), "6:1"),
    "dotted": ("s.a = 1\ns . b = 2", ("s", "b"), "2:5"),
    "dotted, the table": ("s.a = 1\ns.b = 2", ("s",), "1:1"),
    "dotted under a section": ("[s]\nt.a = 1\nt.b.c = 2", ("s", "t", "b", "c"), "3:5"),
    "dotted section": ("[s.t]\na = 1\n[s]\nb = 1", ("s",), "3:1"),
    "dotted section alone": ("\n[ s . t ]\na = 1", ("s",), "2:1"),
    "quoted": ("\"a b\" = 1\n'c.d' = 2", ("c.d",), "2:1"),
    "quoted section": ('["s.t"]\na = 1\n[s.t]\na = 2', ("s", "t", "a"), "4:1"),
    "quoted with an escape": ('"\\u0061" = 1', ("a",), "1:1"),
    "quoted with an equals sign": ('"b = 1 # a" = 1\na = 2', ("a",), "2:1"),
    "empty name": ("'' = 1\na = 2", ("",), "1:1"),
    "number as a name": ("[s]\n1 = 2\n", ("s", "1"), "2:1"),
    "indented": ("[s]\n  \ta = 1", ("s", "a"), "2:4"),
    "indented section": ("b = 1\n   [s]", ("s",), "2:4"),
    "behind other letters": ("b = { 'σ' = 'µ⟂', a = 1 }", ("b", "a"), "1:19"),
    "windows": ("b = '''\r\na = 1\r\n'''\r\n[s]\r\na = 2\r\n", ("s", "a"), "5:1"),
    "entry of an array": ("a = [ # [\n  1,\n  [2, 3] ]", ("a", 1, 1), "3:7"),
    "date": ("d = 1979-05-27 07:32:00Z # x\na = { t = 07:32:00, b = 1 }", ("a", "b"), "2:21"),
}


@pytest.mark.parametrize("case", MISLEADING)
def test_the_place_is_that_of_the_key_itself(case):
    text, path, place = MISLEADING[case]
    assert parsed(text, "f").place(*path) == f"f:{place}"


@pytest.mark.parametrize("case", MISLEADING)
def test_every_path_of_the_document_has_a_place_and_nothing_else_has(case):
    text, _, _ = MISLEADING[case]
    toml = parsed(text, "f")
    assert toml.document == tomllib.loads(text)
    assert set(toml._spots) == set(places(toml.document))


def test_what_is_not_there_has_the_file_as_its_place():
    assert parsed("a = 1", "f").place("b") == "f" and parsed("", "f").place("a", "b") == "f"
    assert parsed("a = 1", "f").written("a") is None is parsed("", "f").written("a")


@pytest.mark.parametrize(
    ("text", "path", "written"),
    [
        ('a = "x + y"', ("a",), ("x + y", 1, 5)),
        ("a = 'x'", ("a",), ("x", 1, 5)),
        ('a = """\n  x +\n y"""', ("a",), ("  x +\n y", 2, 0)),
        ('a = """\r\n  x +\r\n y"""', ("a",), ("  x +\r\n y", 2, 0)),
        ('a = """x \\\n  y"""', ("a",), ("x  \n  y", 1, 7)),
        ("a = '''x''''", ("a",), ("x'", 1, 7)),
        ("[s]\na = [ 'x', # 'z'\n \"y\" ]", ("s", "a", 1), ("y", 3, 2)),
        ("s = { a = ['x'] }", ("s", "a", 0), ("x", 1, 12)),
        ('σ = "é"\n"ω" = "ü"', ("ω",), ("ü", 2, 7)),
        ('a = "\\u0041"', ("a",), ("\\u0041", 1, 5)),
        ('a = ""', ("a",), ("", 1, 5)),
    ],
)
def test_strings_are_taken_as_written(text, path, written):
    if "σ" in text:  # a letter beyond ASCII is no bare key
        text = text.replace("σ", '"σ"')
    assert parsed(text, "f").written(*path) == written


# -- a writer that knows ------------------------------------------------------------------------------------------

NAMES = ["a", "b", "c", "key", "a-b", "x y", "d.e", "σ", "=", "#", "[s]", '"']
TEXTS = ["", "a = 1", "[s]", "# no", "x, y", "{ a = 1 }", "ünï", "'", "]]", "]", "}"]


class Writer:
    """Writes a document in random layouts, and notes where it puts every key."""

    def __init__(self, seed):
        self.draw = random.Random(seed)
        self.text, self.spots, self.contents = "", {}, {}

    def blank(self):
        self.text += self.draw.choice(["", " ", "\t", "  "])

    def line(self):
        self.text += self.draw.choice(["\n", "\n\n", " # a = 1\n", "\t\n  # [s] = '''\n", "\r\n"])

    def key(self, path, name, implied=False):
        if not (implied and path in self.spots):
            self.spots[path] = len(self.text)
        plain = name.isascii() and name.replace("-", "").isalnum()
        quotes = "'" if "'" not in name else '"'
        self.text += name if plain and self.draw.random() < 0.7 else f"{quotes}{name}{quotes}"

    def value(self, path, value):
        if isinstance(value, str):
            styles = [("'", "'"), ("'''\n", "'''"), ("'''", "'''")] if "'" not in value else [('"', '"'), ('"""', '"""')]
            begin, end = self.draw.choice(styles)
            self.text += begin
            self.contents[path] = len(self.text)
            self.text += value + end
        elif isinstance(value, list):
            self.text += "["
            for i, item in enumerate(value):
                self.draw.choice([self.blank, self.line])()
                self.spots[(*path, i)] = len(self.text)
                self.value((*path, i), item)
                self.blank()
                self.text += "," if i + 1 < len(value) or self.draw.random() < 0.5 else ""
            self.draw.choice([self.blank, self.line])()
            self.text += "]"
        elif isinstance(value, dict):
            self.text += "{"
            for i, (name, item) in enumerate(value.items()):
                self.text += "," if i else ""
                self.blank()
                self.entry(path, name, item)
                self.blank()
            self.text += "}"
        else:
            self.text += repr(value).lower()

    def entry(self, path, name, value):
        self.key((*path, name), name)
        self.blank()
        self.text += "="
        self.blank()
        self.value((*path, name), value)

    def table(self, path, names, table):
        """The entries of a table, then its sub-tables under headers of their own."""
        later = {}
        for name, value in table.items():
            as_tables = isinstance(value, dict) or (isinstance(value, list) and value and all(isinstance(v, dict) for v in value))
            if as_tables and self.draw.random() < 0.6:
                later[name] = value
                continue
            self.blank()
            if isinstance(value, dict) and value and self.draw.random() < 0.5:  # dotted
                for i, (inner, item) in enumerate(value.items()):
                    self.text += "\n" if i else ""
                    self.key((*path, name), name, implied=True)
                    self.text += self.draw.choice([".", " . "])
                    self.entry((*path, name), inner, item)
            else:
                self.entry(path, name, value)
            self.line()
        for name, value in later.items():
            for i, each in enumerate(value) if isinstance(value, list) else [(None, value)]:
                self.blank()
                start, brackets = len(self.text), "[[" if i is not None else "["
                inner = (*path, name) if i is None else (*path, name, i)
                self.text += brackets
                for step in names:
                    self.key(("?",), step)
                    self.text += self.draw.choice([".", " ."])
                self.key(("?",), name)
                self.text += brackets.replace("[", "]")
                self.spots.setdefault((*path, name), start)
                self.spots[inner] = start
                self.line()
                self.table(inner, [*names, name], each)
        self.spots.pop(("?",), None)


def document(draw, depth=0):
    def value():
        kind = draw.random()
        if kind < 0.25 and depth < 3:
            return document(draw, depth + 1)
        if kind < 0.4 and depth < 3:
            return [document(draw, depth + 1) for _ in range(draw.randint(1, 3))]
        if kind < 0.55:
            return [draw.choice([1, "a = 1", True, [2, "]"], 3.5, {}]) for _ in range(draw.randint(0, 3))]
        return draw.choice([1, -2.5, True, *TEXTS])

    return {name: value() for name in draw.sample(NAMES, draw.randint(0 if depth else 3, 5))}


@pytest.mark.slow
@pytest.mark.parametrize("block", range(10))
def test_the_places_are_where_the_writer_put_them(block):
    found = 0
    for seed in range(40 * block, 40 * block + 40):
        writer = Writer(seed)
        told = document(writer.draw)
        writer.table((), [], told)
        toml = parsed(writer.text, "f")
        assert toml.document == told, writer.text
        assert set(toml._spots) == set(places(told)), writer.text
        for path, at in writer.spots.items():
            assert offset(writer.text, toml.place(*path)) == at, (path, writer.text)
        for path, at in writer.contents.items():
            written, line, column = toml.written(*path)
            assert offset(writer.text, f"f:{line}:{column + 1}") == at, (path, writer.text)
            value = told
            for key in path:
                value = value[key]
            assert written == value, (path, writer.text)
        found += len(writer.spots)
    assert found > 200


# -- files and faults ---------------------------------------------------------------------------------------------


def test_files_are_read_as_utf8_with_or_without_a_mark(tmp_path):
    (tmp_path / "f").write_bytes("\ufeffa = 'é'\r\n".encode())
    assert parsed(text_of(tmp_path / "f", "file", 100), "f").place("a") == "f:1:1"
    (tmp_path / "g").write_bytes(b"a = 1\nb = '\xe9'\n")
    with pytest.raises(InputError, match=r"g:2: this is not text in UTF-8; is it a scene\?"):
        text_of(tmp_path / "g", "scene", 100)
    with pytest.raises(InputError, match=r"larger than 5 bytes; split it"):
        text_of(tmp_path / "g", "scene", 5, large="split it")
    with pytest.raises(InputError, match=r"no such file; look again"):
        text_of(tmp_path / "h", "scene", 5, absent="look again")


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("a = 1\na = 2\n", "f:2:6", "overwrite"),
        ("[s]\na = 1\n[s]", "f:3:3", "twice"),
        ("s.a = 1\n[s]\n", "f:2:3", "twice"),
        ("a = 1\r\nb = \r\n", "f:2:5", "invalid value"),
        ("a = 1\nb = '", "f:2", "expected"),
        ("a = " + "[" * 100_000, "f", "nests too deeply"),
        ("a = " + "{a=" * 100_000, "f", "nests too deeply"),
        ("a = 1" + "0" * 10_000, "f", "too large"),
    ],
)
def test_what_is_no_toml_is_named_with_its_place(text, place, words):
    with pytest.raises(InputError, match=words) as caught:
        parsed(text, "f")
    assert caught.value.where.startswith(place) and caught.value.remedy


@pytest.mark.parametrize("depth", range(300, 1000, 100))
def test_deep_nesting_is_read_or_refused_in_words(depth):
    try:
        toml = parsed("a = " + "[" * depth + "]" * depth, "f")
    except InputError as fault:
        assert "nests too deeply" in str(fault)
    else:
        assert toml.place("a", *[0] * (depth - 1)) == f"f:1:{4 + depth}"


def test_unknown_names_have_a_near_one_or_all():
    assert meant("stifness", ["law", "stiffness"]) == "did you mean 'stiffness'?"
    assert meant("zzz", ["law", "path"]) == "known are: law, path" and meant("zzz", []) == "known are: none"


# -- limits -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (".".join("a" * 17) + " = 1", 1),
        ("x = 1\n[" + " . ".join(["'a'"] * 17) + "]", 2),
        ("[[" + ".".join(['"a.\\"b"'] * 40_000) + "]]", 1),
        ("x = { b = 1, " + ".".join("a" * 20_000) + " = 1 }", 1),
    ],
)
def test_a_key_of_many_parts_is_refused_before_it_is_read(text, line, monkeypatch):
    """Its cost grows with the square of the parts: 40 kB of them took 10 s and 2 GB."""
    monkeypatch.setattr("tomllib.loads", lambda *_, **__: pytest.fail("it was read"))
    with pytest.raises(InputError, match="more than 16 parts") as fault:
        parsed(text, "f.toml")
    assert fault.value.where == f"f.toml:{line}"


def test_a_key_of_few_parts_and_dots_elsewhere_are_read():
    text = ".".join("a" * 16) + ' = 1\nx = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5]\ny = "' + "1.5, " * 100 + '"\n'
    assert parsed(text, "f.toml").document["x"][1] == 2.5


@pytest.mark.parametrize(
    ("text", "place"), [("n = 0x" + "f" * 4000, "f.toml:1:1"), ("[t]\nn = [1, { m = -" + "9" * 401 + " }]", "f.toml:2:11")]
)
def test_an_integer_too_long_to_be_printed_has_its_place(text, place):
    with pytest.raises(InputError, match="too long") as fault:
        parsed(text, "f.toml")
    assert fault.value.where == place
