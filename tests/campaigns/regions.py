"""For which parameters the laws of the atlas and the built-in ones are convex, beside what was published.

    python -m tests.campaigns.regions                    all laws; exit code 1 where a sentence differs from the one that is kept
    python -m tests.campaigns.regions argyris limacon    these
    python -m tests.campaigns.regions --write            keeps the new sentences in the files

Each law with one or two shape parameters is asked over its own domain.  Many files fix or narrow the parameter in question: what
is asked of them besides stands in the table ``regions`` of the file, as the options of ``duhem region``.
"""

from __future__ import annotations

import argparse
import re
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from duhem import InputError
from duhem.law import catalogue
from duhem.law.atlas.entry import entries, file_of
from duhem.law.catalogue import load_formula
from duhem.regions import FoundRegion, region, shape_parameters

__all__ = ["Answer", "answered", "kept", "questions"]

STEPS, SECONDS, NARROW = 30_000_000, 90, 0.02


@dataclass(frozen=True)
class Answer:
    """What was found of a law with some options: a region, or why there is none; ``seconds`` of processor time."""

    found: FoundRegion | None
    told: str
    seconds: float


def questions(names: Sequence[str] = ()) -> Iterator[tuple[str, str, str, str]]:
    """A law, the options of the command ("" for its own domain), the sentence that is kept, and the published range."""
    known = {said.name: said for said in entries()}
    for name in names or [*catalogue.names(), *(name for name in known if name not in catalogue.names())]:
        said = known.get(name)
        yield name, "", "", said.claims.get("convexity", "") if said else ""
        for options, sentence in said.regions.items() if said else ():
            yield name, options, sentence, said.claims.get(sentence.split()[0], "") if said else ""


def answered(name: str, options: str, steps: int = STEPS, seconds: float = SECONDS) -> Answer | None:
    """The region of a law; None where it has no shape parameter, or more than two, and no options say which are asked for."""
    words = options.split()
    given = [(option, value.partition("=")) for option, value in zip(words[::2], words[1::2], strict=True)]
    over, values = ({p: x for own, (p, _, x) in given if own == option} for option in ("--over", "--set"))
    claim = next((p for option, (p, _, _) in given if option == "--claim"), "convexity")
    start = time.process_time()
    try:
        law = load_formula(name)
        law = law.fix(values) if values else law
        if not over and len(shape_parameters(law)) not in (1, 2):
            return None
        with_alarm(seconds)
        found = region(law, None, claim, over, steps=steps)
        told = found.sentence
    except (InputError, ValueError, ArithmeticError) as fault:  # the last two are defects, which do not end the campaign
        found, told = None, f"{'' if isinstance(fault, InputError) else 'CRASH '}{fault}"
    except KeyboardInterrupt:
        found, told = None, f"no answer within {seconds:.0f} s"
    finally:
        with_alarm(0)
    return Answer(found, told, time.process_time() - start)


def with_alarm(seconds: float) -> None:
    """After so much processor time the search is interrupted as by Ctrl-C, which a paving survives."""
    signal.signal(signal.SIGPROF, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_PROF, seconds)


def kept(text: str, sentences: Mapping[str, str]) -> str:
    """The text of a file of the atlas with these sentences."""
    for options, sentence in sentences.items():
        text, count = re.subn(rf'("{re.escape(options)}" = )".*?"', lambda match, new=sentence: f'{match[1]}"{new}"', text)
        assert count == 1, "the file keeps a sentence of these options"
    return text


def main(arguments: Sequence[str]) -> int:
    """Run the campaign; 1 where a sentence differs from the one that is kept."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.regions", description="the regions of the atlas, anew")
    parser.add_argument("names", nargs="*", help="laws (left out: all)")
    parser.add_argument("--steps", type=int, default=STEPS, help="the budget of each question")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="the limit of processor time of each question")
    parser.add_argument("--kept", action="store_true", help="ask only what the files keep")
    parser.add_argument("--write", action="store_true", help="keep what is found in the files")
    given, counted, code = parser.parse_args(arguments), Counter[str](), 0
    for name, options, before, published in questions(given.names):
        if (given.kept and not options) or (answer := answered(name, options, given.steps, given.seconds)) is None:
            continue
        kind = "unanswered" if answer.found is None else "exact" if answer.found.exact else "open"
        kind = f"at most {NARROW:.0%} open" if answer.found is not None and 0 < answer.found.open_share <= NARROW else kind
        counted[kind] += 1
        changed = bool(options) and answer.told != before
        row = f"{name} {options}".strip(), kind, f"{answer.seconds:.1f} s", answer.told, f"published: {published or '-'}"
        print(*row, sep=" | ", flush=True)
        if changed and given.write and answer.found is not None and (file := file_of(name)) is not None:
            file.write_text(kept(file.read_text("utf-8"), {options: answer.told}), "utf-8")
        elif changed:
            print(f"    differs from: {before}", flush=True)
            code = 1
    print(f"{counted.total()} regions: {', '.join(f'{n} {kind}' for kind, n in counted.most_common())}")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
