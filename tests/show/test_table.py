"""One table printer, one page: within the width, in columns that line up, with nothing lost."""

import io
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from duhem.show.page import LEAST, READABLE, WIDTH, Page, table, terminal_width, tied

VERDICTS = [
    ("claim", "verdict", "method", "scope", "time"),
    ("origin", "proved", "evaluation (sign-rules)", "all other parameters, mu_a_plus = 1/5, mu_a_minus = 1/3", "0.01 s"),
    ("convexity", "proved", "composition", "all parameters", "1234.56 s"),
]
TIMES = [
    ("method", "setting", "error in stress", "error in slip", "flagged", "time", "least to most"),
    ("closed-form", "", "2.0e-16", "3.3e-14", "0", "545 us", "140 us to 545 us, 5 runs"),
    ("cvxpy CLARABEL", "tolerance 1e-04", "1.2e-03", "2.1e-02", "4", "12.7 ms", "12 ms to 14 ms, 5 runs"),
    ("newton", "", "failed: ArithmeticError: no answer to any of the increments that were asked for, whatever was tried"),
]

WORDS = st.text("abcxyz019.-", min_size=1, max_size=12)
CELLS = st.lists(WORDS, max_size=6).map(" ".join)


@st.composite
def tables(draw: st.DrawFn) -> tuple[list[list[str]], str]:
    count = draw(st.integers(1, 6))
    rows = draw(st.lists(st.lists(CELLS, min_size=count, max_size=count), min_size=1, max_size=5))
    short = draw(st.lists(st.lists(CELLS, min_size=1, max_size=count), max_size=2))
    return [*rows, *short], "".join(draw(st.lists(st.sampled_from("lr"), min_size=1, max_size=count)))


def words(text: str) -> list[str]:
    return sorted(text.split())


@pytest.mark.parametrize("width", [60, 96, 200])
@pytest.mark.parametrize(("rows", "align"), [(VERDICTS, "llllr"), (TIMES, "llrrrrl")], ids=["verdicts", "times"])
def test_no_line_is_longer_than_the_width(rows: list[tuple[str, ...]], align: str, width: int) -> None:
    lines = table(rows, align, "  ", width=width)
    assert max(map(len, lines)) <= width
    shown = " ".join(lines).split()
    assert all(word in shown for row in rows for cell in row for word in cell.split())


@pytest.mark.slow
@given(tables(), st.integers(40, 200))
def test_a_wide_table_says_all_that_an_endless_one_says(drawn: tuple[list[list[str]], str], width: int) -> None:
    rows, align = drawn
    wide, narrow = table(rows, align), table(rows, align, width=width)
    assert words(" ".join(wide)) == sorted(word for row in rows for cell in row for word in cell.split())
    first = sorted(word for row in rows for word in row[0].split())
    more = words(" ".join(narrow))
    for word in words(" ".join(wide)):
        more.remove(word)
    blocks = narrow.count("") + 1  # each further block begins with the first column again
    assert set(more) <= set(first) and len(more) <= (blocks - 1) * len(first)
    if max(map(len, wide)) <= width:
        assert narrow == wide


@pytest.mark.slow
@given(tables(), st.integers(40, 200))
def test_text_of_short_words_always_fits(drawn: tuple[list[list[str]], str], width: int) -> None:
    rows = [row for row in drawn[0] if len(row) == len(drawn[0][0])]
    assert max(map(len, table(rows, "l", width=width))) <= width


def test_columns_line_up() -> None:
    for width in (60, 96, 200):
        block: list[str] = []
        for line in [*table(VERDICTS, "llllr", width=width, rule=True), ""]:
            if line:
                block.append(line)
                continue
            edges = [match.span() for match in re.finditer("-+", block[1])]
            for row in [block[0], *block[2:]]:
                between = set(range(len(block[1]))) - {i for start, end in edges for i in range(start, end)}
                assert all(row.ljust(len(block[1]))[i] == " " for i in between)
            block = []


def test_numbers_end_where_their_heading_ends() -> None:
    head, *rows = table([("law", "value"), ("a", "0.25"), ("b", "-12.5")], "lr")
    assert {len(line) for line in (head, *rows)} == {len("law  value")}


def test_headings_over_numbers_are_folded_before_text_is() -> None:
    assert table([("law", "largest error", "what it says"), ("oval", "2.5e-16", "an ellipse beside the origin")], "lrl", width=43) == [
        "law   largest  what it says",
        "        error",
        "oval  2.5e-16  an ellipse beside the origin",
    ]


def test_text_is_folded_in_its_own_column() -> None:
    assert table([("law", "what it says", "n"), ("oval", "an ellipse whose centre is off the origin", "2")], "llr", width=30) == [
        "law   what it says           n",
        "oval  an ellipse whose       2",
        "      centre is off the",
        "      origin",
    ]


def test_columns_without_room_follow_below_the_first_one_again() -> None:
    rows = [("x", *(f"column-{i}-of-five" for i in range(5))), ("row", *(str(i) for i in range(5)))]
    lines = table(rows, "lr", width=40)
    assert lines.count("") == 2 and [line for line in lines if line.startswith("row")] == [
        "row                 0                 1",
        "row                 2                 3",
        "row                 4",
    ]


def test_a_row_that_ends_early_runs_on() -> None:
    lines = table(TIMES, "llrrrrl", width=200)
    assert lines[-1].endswith(TIMES[-1][-1])
    folded = table(TIMES, "llrrrrl", width=110)
    at = folded[0].index("error in stress")
    assert folded[-2][at:].startswith("failed:") and folded[-1][:at].strip() == ""


@pytest.mark.parametrize("width", [60, 96, 200])
def test_prose_is_never_wider_than_the_page_nor_than_can_be_read(width: int) -> None:
    text = "the stress that attains the supremum: the evolution law solved for sigma, at nonzero slip rate " * 4
    lines = [*Page(width).field("claim", text, 12), *Page(width).item(text), *Page(width).hanging(text)]
    assert max(map(len, lines)) <= min(width, READABLE)
    assert words(" ".join(lines)) == sorted(["claim", *text.split() * 3])
    assert len(Page(None).hanging(text)) == 1


def test_what_is_tied_stays_on_one_line_and_shows_its_spaces() -> None:
    for width in range(40, 70):
        lines = Page(width).hanging(", ".join(tied(f"mu_{i} = 1/{i}") for i in range(20)))
        assert all(f"mu_{i} = 1/{i}" in "\n".join(lines) for i in range(20))


def test_lists_have_a_title_only_if_they_have_items() -> None:
    assert Page().items("Left out", []) == []
    assert Page().items("Left out", ["a: b"]) == ["Left out", "  a: b"]


def test_parts_without_lines_leave_no_gap() -> None:
    assert Page().report([["a "], [], ["b", "c"]]) == "a\n\nb\nc"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_the_width_is_the_terminals_where_there_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    for columns in (60, 96, 200):
        monkeypatch.setenv("COLUMNS", str(columns))
        assert terminal_width(Terminal()) == columns
        assert terminal_width(io.StringIO()) is None
    monkeypatch.setenv("COLUMNS", "7")
    assert terminal_width(Terminal()) == LEAST < WIDTH
