"""What helps where a claim stays open, tried out: the law with a constraint, ranges, narrower or fixed parameters, put to the kernel.

Each trial is a law of which less is claimed.  One that is proved says what the rules lack: nothing is suggested that was not seen to help.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import islice, product, takewhile
from typing import Any, NamedTuple

from duhem.proof.decide import Budget
from duhem.proof.kernel.bounds import NEGATIVE, POSITIVE, ZERO, Bounds
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import needs_of, objection, rules_of
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw, inhabited
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import UNREADABLE, Term, minus, parse, sum_of
from duhem.proof.unsettled.blocked import Blocked
from duhem.proof.unsettled.ranges import between
from duhem.proof.unsettled.term_text import in_text
from duhem.proof.verdict import Verdict

__all__ = ["Attempts", "Rewriting", "settings", "that_help"]

Text = Mapping[str, Any]  # a law as the kernel reads it
Choice = Mapping[str, Fraction]
Choices = Callable[[Iterable[Choice]], Iterable[Choice]]  # those of some at which K is not empty, and more
RangesAt = Callable[[Choice], Iterable[Text]]  # of the forces, around the boundary at some values of the parameters, the widest first
Decide = Callable[[str, Text, Budget], Verdict | None]  # the verdict on a claim of a changed law; None where it is open
_IN_ALL, _SHARE = 9_000_000, 3  # steps for all claims of a law; one claim may use 1/_SHARE of what is left
_A_TRIAL, _A_KIND, _IN_A_BOX, _A_DECISION, _READING = 200_000, 400_000, 300_000, 250_000, 5_000  # steps; for reading a law
_BEFORE = ("origin", "convexity", "smoothness", "normality", "dissipation", "state_laws", "homogeneity")
_TOLD = _BEFORE[:5]  # those of which it is said that they are proved too
_PLAIN = tuple(map(Fraction, ("1", "2", "1/2", "1/10", "3", "-1")))
_WIDENING = 1_000_000  # steps to free parameters and to widen ranges
_TURNS, _MOST_CHOICES, _MOST_FIXED = 7, 6, 4  # of plain values; of those at which everything that decides is asked
_MOST_DECIDED, _MOST_DUALS, _MOST_BOXED = 16, 3, 2  # times that everything is asked about one claim; choices tried in a box
_TIMES, _WIDE = 8, 4  # as many steps as for a box with fixed parameters may be spent to widen it
_MOST_ALONE, _MOST_INSIDE = 4, 2  # parameters of which one alone is fixed; of which other values inside a range are tried
_LONGEST = 120  # letters of a constraint
_CURVES = ("curvature-in-a-box",)
_IN_BOXES = {"convexity": _CURVES, "normality": _CURVES, "smoothness": ("slope-in-a-box",), "dissipation": ("power-in-a-box",)}
_MOST_FORCES = 3  # of a law that may be meant for one sign of a force
_SIDES = {"min": ">=", "max": "<="}  # what a range that ends at 0 says of a force
_MOST_FORMS, _MOST_SIGNS = 2, 8  # beside g itself; of constants whose sign is asked


class Rewriting(NamedTuple):
    """What to write, and the formula ``of`` the law then, g or the energy, or its ``forces_of_rates``.

    It is ``at_tip`` where a part without a value has one in it.
    """

    told: str
    written: str | Mapping[str, str]
    at_tip: bool = False
    of: str = "g"


@dataclass
class Attempts:
    """What was tried of one law for all its open claims: each claim of each changed law once, within so many ``steps``.

    ``answers`` say whether the kernel proves a claim of a changed law, ``verdicts`` are those of everything that decides.  What ``helped``
    one claim, and the values at which one was found to be ``failing``, are tried first of the next.
    """

    steps: int = _IN_ALL
    answers: dict[str, dict[str, bool]] = field(default_factory=dict)
    verdicts: dict[tuple[str, str], Verdict | None] = field(default_factory=dict)
    helped: dict[str, Text] = field(default_factory=dict)
    failing: list[Choice] = field(default_factory=list)


def that_help(
    claim: str, law: Text, settled: frozenset[str], blocked: Blocked | None, choices: Choices,
    forms: Callable[[], Sequence[Rewriting]] = tuple, decide: Decide | None = None, first: Sequence[Choice] = (),
    tried: Attempts | None = None, ranges: RangesAt = lambda _: (),
) -> list[str]:  # fmt: skip
    """What to do, so that the claim is settled: one action a kind, each seen to help.

    ``choices`` gives values of the free parameters at which it is tried, and of plain ones those at which K is not empty, for of an
    empty K much is proved.  ``forms`` are other forms of g with the same K.  At the values that are tried ``first`` the claim may fail.
    """
    asked = _Asked(claim, law, settled, decide, tried or Attempts())
    alone = [{name: x} for values in first for name, x in [*values.items()][:_MOST_ALONE]]  # in whose place the others may be anything
    fails = next((x for x in (*asked.tried.failing, *alone, *first) if asked.decided(_with(law, x)) is Verdict.REFUTED), None)
    if fails is not None and fails not in asked.tried.failing:
        asked.tried.failing.append(fails)
    refuted = [] if fails is None else [_refuted("", fails)]
    part = frozenset[str]() if blocked is None else blocked.part.names().union(*(c.names() for c in blocked.signs))

    def either(changed: Text) -> bool:  # the power may be a share of g and a rest, which is evidence
        return asked(changed) or (claim == "dissipation" and not found and asked.decided(changed) is Verdict.PROVED)

    def first_of(kind: Iterable[tuple[str, Text]], way: Callable[[Text], bool] = asked) -> list[str]:
        asked.steps = _A_KIND  # for each kind anew
        return [asked.keep(*best) for best in islice((each for each in kind if way(each[1])), 1)]

    asked.kept += 2 * _A_KIND
    found = first_of(_signs(law, blocked, choices)) if blocked else []  # a constraint says more than values that helped before
    helped = () if found else asked.tried.helped.items()
    again = [told for told, changed in helped if asked(changed)]
    if again := again or [told for told, changed in helped if claim != "duality" and asked.decided(changed) is Verdict.PROVED]:
        return [*again, *refuted]
    found += first_of(_ranges(law, blocked), either) if blocked else []
    if found := [*(found or _with_least_lost(law, ((form.told, _changed(law, form, {})) for form in forms()), asked)), *refuted]:
        return found
    # where g has no value at a tip, it is no parameter that is to blame; a closed form takes long to look for
    known, asked.steps = [*choices(_choices(law))], _A_KIND
    narrow = known and not any(form.at_tip for form in forms()) and claim != "duality" and any(asked(_with(law, x)) for x in known[:2])
    fixed = partial(_fixed, law, forms(), part, known, choices, asked)
    if found := (narrow and _narrowed(law, sorted(known[0]), known, {}, asked)) or fixed(thorough=False, off=0):
        return found
    asked.steps = _A_KIND
    beside = (told for told, changed in _beside_tips(law, part, forms()) if asked(changed)) if claim == "smoothness" else ()
    if found := [*islice(beside, 1)] or first_of(_one_sided(law)) or fixed(thorough=True, off=0) or fixed(thorough=False, off=1):
        return found
    asked.kept -= _A_KIND  # for ranges of forces and values, as much as was kept for them
    boxed, wide = _boxed(law, known[:_MOST_BOXED] or ({},), ranges, asked)
    asked.kept -= _A_KIND
    gone = () if wide else (fixed(thorough=thorough, off=off) for thorough, off in ((False, 2), (True, 1), (True, 2)))
    return next(filter(None, gone), None) or [asked.keep(*each) for each in boxed]


class _Asked:
    """The kernel, and everything that decides, about one open claim of a law and of that with changes, as long as steps are left."""

    def __init__(self, claim: str, law: Text, settled: frozenset[str], decide: Decide | None, tried: Attempts) -> None:
        self.claim, self.g, self.settled, self.decide, self.tried = claim, law.get("g"), settled, decide, tried
        self.decisions = _MOST_DECIDED if claim != "duality" else _MOST_DUALS
        self.steps, self.kept = _A_KIND, tried.steps - tried.steps // _SHARE  # for the claims that come after

    def decided(self, law: Text) -> Verdict | None:
        """Proved or refuted; None where it is open, or no steps are left."""
        if self.decide is None or (self.claim == "dissipation" and self(law)):  # which rests on other claims
            return Verdict.PROVED if self(law) else None
        key = self.claim, _key(law)
        if key not in self.tried.verdicts:
            if self.steps < 0 or self.tried.steps <= self.kept or self.decisions == 0:
                return None
            self.decisions -= 1
            budget = Budget(_A_DECISION)
            self.tried.verdicts[key] = self.decide(self.claim, law, budget)
            self._pay(budget.spent)
        return self.tried.verdicts[key]

    def by_rules(self, law: Text) -> Verdict | None:
        """Proved without evidence, for few steps; else None."""
        return Verdict.PROVED if self(law, most=_A_TRIAL // _SHARE) else None

    def __call__(self, law: Text, claim: str = "", rules: Sequence[str] = (), most: int = _A_TRIAL) -> bool:
        """Whether it proves the claim, or another, without evidence, with what that may rest on; of g itself holds what is settled.

        Some ``rules`` are asked before all others; it may cost so many steps at ``most``.
        """
        key, claim = _key(law), claim or self.claim
        if claim == "duality":  # which needs evidence
            return self.decide is not None and self.decided(law) is Verdict.PROVED
        answers = self.tried.answers.setdefault(key, {})
        known = {name for name in _BEFORE if answers.get(name) or self.tried.verdicts.get((name, key)) is Verdict.PROVED}
        known |= self.settled if law.get("g") == self.g else self.settled & {"origin"}  # other forms of g have the same K
        by = " ".join((claim, *rules))
        if claim in known or by in answers or self.steps < 0 or self.tried.steps <= self.kept:
            return claim in known
        alone = bool(rules) and claim in ("smoothness", "dissipation")  # which rest on nothing else then, and take fewer steps
        with within(most) as purse, suppress(*UNREADABLE, TooDearError):
            read, needed = stated(law), {claim}
            for name in reversed(() if alone else _BEFORE):
                needed |= needs_of(name, read) if name in needed else set()
            for name in (name for name in _BEFORE if name in needed - known and (name == claim or name not in answers)):
                answers[name] = any(not objection(name, rule, frozenset(known), read, {}) for rule in (*rules, *rules_of(name, read)))
                known |= {name} if answers[name] else set()
        answers.setdefault(by, False)
        self._pay(purse.spent)
        return claim in known

    def widens(self) -> None:
        """Steps to claim more of what was found, from those of the next claims if need be, as these are tried with it first."""
        self.steps, self.kept = _WIDENING, max(0, self.kept - _WIDENING)

    def _pay(self, spent: int) -> None:
        self.steps -= spent + _READING
        self.tried.steps -= spent + _READING

    def keep(self, told: str, law: Text) -> str:
        """What to do, with the claims that are then proved too, once; the next claims are tried with it first."""
        if told in self.tried.helped:
            return told
        self.tried.helped[told] = law
        more = [name for name in _TOLD if name not in (self.claim, *self.settled) and self(law, name)]
        return f"{told} ({', '.join(more)} {'are' if more[1:] else 'is'} proved then, too)" if more else told


def _key(law: Text) -> str:
    return json.dumps(law, sort_keys=True, default=str)


def _with_least_lost(law: Text, forms: Iterator[tuple[str, Text]], asked: _Asked) -> list[str]:
    """The form of g of which the claim is proved, and all that is proved of the law as it is, or most; what is open then is said."""
    asked.steps, found = _A_KIND, list[tuple[int, str, Text]]()
    for told, changed in forms:
        if asked(changed):
            claims = [name for name in _BEFORE[:3] if name != asked.claim and asked(law, name)]
            lost = [name for name in claims if not asked(changed, name)]
            more = f" (for this claim alone: {' and '.join(lost)} would be open)" if lost else ""
            found.append((len(lost), told + more, changed))
            if not lost:
                break
    return [asked.keep(told, changed) for _, told, changed in sorted(found, key=lambda each: each[0])[:1]]


def _signs(law: Text, blocked: Blocked, choices: Choices) -> Iterator[tuple[str, Text]]:
    """Constraints that hold somewhere: of a law without parameters that satisfy it every claim would be shown, and nothing be said."""
    read = stated(law)
    own = sorted(
        (c for c in blocked.signs if c.names() and not any(x.op == "**" and not x.args[0].names() for x in c.parts())), key=Term.size
    )
    if isinstance(read, StatedLaw):  # what is never > 0 would say that it is 0
        own = [c for c in own if over(read).facts(c).sign & POSITIVE]
    sides = [tuple(own[:n]) for n in range(1, len(own) + 1)] if blocked.strict else [*((c,) for c in own), tuple(own)]
    sides += [(c,) for c in blocked.beside[:_MOST_SIGNS]]
    for constants, strict in product(dict.fromkeys(filter(None, sides)), (True,) if blocked.strict else (False, True)):
        texts = [_compared(constant, strict) for constant in constants]
        changed = {**law, "constraints": [*law["constraints"], *texts]}
        if max(map(len, texts)) <= _LONGEST and any(_inhabits(choice, changed) for choice in choices(_choices(changed))):
            quoted = " and ".join(f'"{text}"' for text in texts)
            yield f"add the constraint{'s' if texts[1:] else ''} {quoted}", changed


def _compared(constant: Term, strict: bool) -> str:
    """That it is >= 0, or > 0, with what is taken away in it on the other side."""
    texts = [in_text(a, {}) for a in (constant.args if constant.op == "+" else (constant,))]
    less, more = [t[1:] for t in texts if t.startswith("-")], [t for t in texts if not t.startswith("-") and t != "0"]
    return f"{' + '.join(less) or 0} {'<' if strict else '<='} {' + '.join(more) or 0}"


def _ranges(law: Text, blocked: Blocked) -> Iterator[tuple[str, Text]]:
    """Yield ranges of one sign for forces of the part, unless it is a sum, or 0 at a tip."""
    ranges, part = law.get("domain", {}), blocked.part
    if len(law["forces"]) > _MOST_FORCES or part.op in ("+", "norm") or not isinstance(read := stated(law), StatedLaw):
        return
    if part.op in ("**", "log") and not over(read).facts(part.args[0]).sign & NEGATIVE:
        return
    for force, end in product(sorted(part.names() & {*read.forces} - {*ranges}), _SIDES):
        yield _of_one_sign(law, {force: end})


def _one_sided(law: Text) -> Iterator[tuple[str, Text]]:
    """Yield ranges of one sign for all forces that have none, of a law of few forces."""
    free = [x for x in law["forces"] if x not in law.get("domain", {})]
    for ends in product(_SIDES, repeat=len(free)) if 1 < len(free) <= _MOST_FORCES else ():
        yield _of_one_sign(law, dict(zip(free, ends, strict=True)))


def _of_one_sign(law: Text, ends: Mapping[str, str]) -> tuple[str, Text]:
    """The law for forces of one sign alone, whose ranges have these ends at 0, and what to do."""
    told, own = " and ".join(f"{x} {_SIDES[end]} 0" for x, end in ends.items()), {x: {end: "0"} for x, end in ends.items()}
    changed = {**law, "domain": {**law.get("domain", {}), **own}}
    return f"ask for {told} alone: {_entries(own)} in the section [domain]", changed


def _moved(law: Text, part: frozenset[str]) -> Iterator[tuple[str, Text]]:
    """Yield K moved along a load of a part by a parameter > 0: what is smooth then is so wherever the load is not 0."""
    g, ranges = parse(law["g"]), law.get("domain", {})
    for force, (side, sign) in product(sorted(law["forces"], key=lambda x: x not in part), (("min", "+"), ("max", "-"))):
        if force not in ranges and (force not in part or len(part & {*law["forces"]}) > 1):
            continue
        x, end, own = Term("name", name=force), Term("name", name=f"{force}_end"), ranges.get(force, {"min": "0"})
        if str(own.get(side)) == "0" and end.name not in law["parameters"]:
            moved = in_text(g.put({x: sum_of(x, end if sign == "+" else minus(end))}), {})
            told = f"write {force} {sign} {end.name} for {force}, with the parameter {end.name} = {{ positive = true }}"
            told += "" if force in ranges else f" and {force} = {{ min = 0 }} in the section [domain]"
            declared = {**law["parameters"], end.name: {"positive": True}}
            changed = {**law, "g": moved, "parameters": declared, "domain": {**ranges, force: own}}
            yield f"{told}: what is proved then is so of K wherever {force} is not 0", changed


def _beside_tips(law: Text, part: frozenset[str], forms: Sequence[Rewriting]) -> Iterator[tuple[str, Text]]:
    """K, or K by another form of g, moved from where a load is 0: nothing but smoothness of a moved K is true of K itself."""
    for form in (None, *forms[:_MOST_FORMS]) if "g" in law else ():
        for told, changed in _moved(_changed(law, form, {}), part):
            yield f"{form.told}, and then {told}" if form else told, changed


def _fixed(
    law: Text, forms: Sequence[Rewriting], part: frozenset[str], known: Sequence[Choice], choices: Choices, asked: _Asked,
    thorough: bool, off: int,
) -> list[str]:  # fmt: skip
    """A form of g, or g with the fewest parameters fixed or narrowed, of which the claim is settled.

    Where it is ``thorough`` everything that decides is asked, and else the rules.  Where the values are ``off`` by 1, one of them is an end
    of its range, and by 2 one is 0, and an effect is gone.
    """
    own = {x: Bounds.read(law["parameters"][x]) for values in known[:1] for x in values}
    every = [values for values in _values(own, part, known) if _off(values, own) == off]
    settles = asked.decided if thorough else asked.by_rules
    asked.steps = (asked.tried.steps - asked.kept) // _SHARE if thorough else _A_KIND
    alone = [{x: known[0][x]} for x in sorted(own, key=lambda x: x not in part)[:_MOST_ALONE] if own[x].holds(known[0][x])]
    every = [{}, *(values for values in alone if len(own) > 1), *every] if thorough and not off else every
    for values in every:
        for form in (None, *forms[:1]) if values else forms[:_MOST_FORMS]:
            verdict = settles(_changed(law, form, values))
            if verdict is Verdict.REFUTED:
                asked.tried.failing += [] if form else [values]
                return [_refuted(form.told if form else "", values)]
            whole = {**known[0], **values} if values else {}
            if verdict and (not values or (_inhabits(whole, law) and next(iter(choices([whole])), None) == whole)):
                return [_with_fewest(law, form, values, part, asked)]
    return []


def _off(values: Choice, own: Mapping[str, Bounds]) -> int:
    """2 where one is 0, 1 where one is an end of its range, else 0."""
    return 2 if 0 in values.values() else 1 if any(x in (own[name].low, own[name].high) for name, x in values.items()) else 0


def _values(own: Mapping[str, Bounds], part: frozenset[str], known: Sequence[Choice]) -> Iterator[Choice]:
    """Plain values, one of them another, at an end of its range, at 1 or 0, those of a part first, all at 1 or 0, and other plain ones."""
    yield from known[:1]
    for plain in known[:1]:
        order = sorted(plain, key=lambda x: x not in part)
        for x in order:
            low, high = own[x].low, own[x].high
            inside = list[Fraction]()
            if low is not None and high is not None and x in order[:_MOST_INSIDE]:
                inside = [(3 * low + high) / 4, (low + 3 * high) / 4]
            ends = (*inside, high, low, Fraction(1), Fraction(0))
            yield from ({**plain, x: end} for end in dict.fromkeys(ends) if end is not None and own[x].holds(end))
        yield from ({x: end if own[x].holds(end) else plain[x] for x in plain} for end in map(Fraction, (0, 1)))
    yield from known[1:_MOST_FIXED]


def _boxed(law: Text, known: Sequence[Choice], ranges: RangesAt, asked: _Asked) -> tuple[list[tuple[str, Text]], bool]:
    """Ranges of the forces in which enclosures show the claim, and of the parameters, and whether each is a quarter of K or more.

    The narrowest are asked first, as these cost least.  As far as the claim is shown, each parameter may then have any value, each force
    has the widest range or more of it, and a parameter any value around that which was tried.
    """
    cost = 0  # steps for the widest yet

    def shown(changed: Text, times: int = 1) -> bool:
        """Whether it is shown, where so many times the steps are left, as what is wider takes more."""
        nonlocal cost
        before, most = asked.tried.steps, _IN_A_BOX if times == 1 else min(_IN_A_BOX, _TIMES * cost or _IN_A_BOX)
        if holds := times * cost <= _IN_A_BOX and asked(changed, rules=_IN_BOXES[asked.claim], most=most):
            cost = before - asked.tried.steps
        return holds

    for values in known if asked.claim in _IN_BOXES else ():
        asked.steps, boxes, free = _A_KIND, [*ranges(values)], law["parameters"]
        if not (found := [*takewhile(shown, ({**_with(law, values), "domain": box} for box in reversed(boxes)))]):
            continue
        boxed = found[-1]
        asked.widens()
        ended = {x: free[x] for x in values if None not in (Bounds.read(free[x]).low, Bounds.read(free[x]).high)}
        wider = [("parameters", [way]) for way in (ended, *({x: free[x]} for x in values))]
        wider += [("domain", [{x: side} for side in between(boxed["domain"][x], boxes[0][x])]) for x in boxes[0]]
        wider += [("parameters", [{x: part} for part in _around(free[x], value)]) for x, value in values.items()]
        for section, ways in wider:
            if section == "domain" or any("value" in boxed[section][x] for way in ways[:1] for x in way):  # it is not free yet
                holds = partial(shown, times=1 if section == "domain" else 2)
                boxed = next(filter(holds, ({**boxed, section: {**boxed[section], **way}} for way in ways)), boxed)
        box, narrower = boxed["domain"], {x: own for x in values if (own := boxed["parameters"][x]) != law["parameters"][x]}
        fixed = {x: narrower.pop(x)["value"] for x in values if "value" in narrower.get(x, ())}
        near = "a part of K" if any(between(box[x], boxes[0][x]) for x in law["forces"]) else "K"
        near = f"ask for {'these forces' if 'viscous' in law else f'forces near {near}'} alone: {_entries(box)} in the section [domain]"
        own = " (or set values of your own: ranges are then sought for them)" if fixed else ""
        told = (near, f"{_entries(narrower)} in the section [parameters]" if narrower else "", settings(fixed) + own)
        wide = all(_WIDE * _length(box[x]) >= _length(boxes[0][x]) for x in law["forces"])
        return [(" and ".join(filter(None, told)), boxed)], wide
    return [], False


def _entries(ranges: Mapping[str, Text]) -> str:
    """As the section of a criterion file has them."""
    return " and ".join(f"{x} = {{ {', '.join(f'{end} = {_in_a_file(own[end])}' for end in own)} }}" for x, own in ranges.items())


def _length(side: Text) -> Fraction:
    return Fraction(side["max"]) - Fraction(side["min"])


def _around(domain: Text, value: Fraction) -> Iterator[Text]:
    """Ranges of a parameter around a value, within its own: from the value or up to it, halfway to the ends, and close to it."""
    own, half = Bounds.read(domain), abs(value) / 2
    low = value - half if own.low is None or own.open else own.low
    high = value + half if own.high is None else own.high
    parts = [(value, high), (low, value), ((low + value) / 2, (value + high) / 2), *((value - x, value + x) for x in [half / 5])]
    for part in (own.above(a, False).below(b, False) for a, b in ([(low, high)] if (low, high) != (own.low, own.high) else []) + parts):
        if not part.single:
            yield {"min": str(part.low), "max": str(part.high)}


def _with_fewest(law: Text, form: Rewriting | None, fixed: Choice, part: frozenset[str], asked: _Asked) -> str:
    """What is proved with values fixed, with as few of them as may be, those of a ``part`` the longest, and one of these narrowed."""
    told = form.told if form else ""
    asked.widens()
    others = [name for name in fixed if name not in part]  # an effect that is gone at 0 is the likeliest that matters
    ways = ([name for name in others if fixed[name]], others, *([x] for x in sorted(fixed, key=lambda x: (not fixed[x], x in part))))
    for freed in ways:
        fewer = {x: value for x, value in fixed.items() if x not in freed}
        changed = _changed(law, form, fewer)
        if fewer != fixed and (fewer or form) and (asked.by_rules(changed) or asked.decided(changed) is Verdict.PROVED):
            fixed = fewer
    for name in fixed if "boundary" not in law else ():  # to read a curve takes long
        more = {x: value for x, value in fixed.items() if x != name}
        if found := _narrowed(_changed(law, form, {}), [name], [fixed], more, asked):
            return " and ".join(filter(None, (told, *found)))
    return asked.keep(" and ".join(filter(None, (told, settings(fixed)))), _changed(law, form, fixed))


def _refuted(told: str, values: Choice) -> str:
    return f"{' and '.join(filter(None, (told, settings(values))))} (then it is refuted)"


def settings(values: Mapping[str, Any]) -> str:
    """As the command line has them."""
    return " ".join(f"--set {name}={value}" for name, value in values.items())


def _in_a_file(x: Any) -> str:
    """A number as a criterion file has it: a fraction as text."""
    return f'"{x}"' if "/" in f"{x}" else f"{x}"


def _narrowed(law: Text, names: Sequence[str], known: Sequence[Choice], others: Choice, asked: _Asked) -> list[str]:
    """A part of the domain of one parameter, with one of the values known, in which the claim is proved, others fixed beside."""
    parts = [(name, *part) for name in names for part in _narrower(law["parameters"][name], [x[name] for x in known if len(known) == 1])]
    for name, domain, told in sorted(parts, key=lambda part: (" = " in part[2], law["parameters"][part[0]].get("max") is None)):
        holds, changed = Bounds.read(domain).holds, {**law, "parameters": {**law["parameters"], name: domain}}
        if any(holds(choice[name]) for choice in known) and asked(_with(changed, others)):
            told = f"narrow {name} to {told}" + "".join(f" and --set {x}={value}" for x, value in others.items())
            if law.get("g") == asked.g:
                asked.tried.helped[told] = _with(changed, others)
            return [told]
    return []


def _choices(law: Text) -> Iterator[dict[str, Fraction]]:
    """A few plain values of the parameters, all together, within the constraints."""
    free = {name: list(_plain(domain)) for name, domain in law["parameters"].items() if not Bounds.read(domain).single}
    own, turns = law["parameters"], product(range(_TURNS), (1, 0))  # those without an upper end each at another place, and all alike
    tried = ({x: v[(k + step * (i % 3) * (not own[x].get("max"))) % len(v)] for i, (x, v) in enumerate(free.items())} for k, step in turns)
    seen = list[dict[str, Fraction]]()
    for choice in tried if all(free.values()) and free else ():
        if choice not in seen and len(seen) < _MOST_CHOICES and _inhabits(choice, law):
            seen.append(choice)
            yield choice


def _inhabits(choice: Choice, law: Text) -> bool:
    """Whether the free parameters may have these values."""
    with suppress(*UNREADABLE):
        read = stated(law)
        fixed = {name: x.low for name, x in read.parameters.items() if name not in choice and x.low is not None and x.single}
        if inhabited(read.parameters, read.constraints, {**fixed, **choice}):
            return True
        here = StatedLaw.read(_with(law, choice)) if all(read.parameters[name].holds(value) for name, value in choice.items()) else None
        return isinstance(here, StatedLaw) and all(over(here._replace(constraints=())).decided(c) for c in here.constraints)
    return False


def _changed(law: Text, form: Rewriting | None, fixed: Choice) -> Text:
    """The law with another formula, and fixed parameters."""
    if form is None:
        return _with(law, fixed)
    changed = {**law, form.of: form.written}
    if form.of == "g":
        changed = {"flow": None, **{key: own for key, own in changed.items() if key != "surfaces"}}
    return _with(changed, fixed)


def _with(law: Text, fixed: Choice) -> Text:
    return {**law, "parameters": {**law["parameters"], **{name: {"value": str(value)} for name, value in fixed.items()}}}


def _narrower(domain: Text, values: Sequence[Fraction]) -> Iterator[tuple[dict[str, Any], str]]:
    """Parts of a domain: above 0, from 1 or up to 1, or either half, from values or up to them, below 0; as declared and in words."""
    if (own := Bounds.read(domain)).single:
        return
    if own.sign() & (ZERO | NEGATIVE) and own.sign() & POSITIVE:
        yield {"positive": True, **({} if own.high is None else {"max": str(own.high)})}, "what is > 0 (positive = true)"
    beyond = Fraction(1) if own.low is None or own.low < 1 else own.low + 1
    middle = beyond if own.low is None or own.high is None else (own.low + own.high) / 2
    for end in (end for end in dict.fromkeys((middle, *values, Fraction(0))) if own.holds(end) and end not in (own.low, own.high)):
        yield {"min": str(end), **({} if own.high is None else {"max": str(own.high)})}, f"min = {_in_a_file(end)}"
        below = {"positive": True} if own.open and own.low == 0 else {} if own.low is None else {"min": str(own.low)}
        yield {**below, "max": str(end)}, f"max = {_in_a_file(end)}"


def _plain(domain: Text) -> Iterator[Fraction]:
    """A few plain values that lie in it: its middle, plain ones, halves of its ends, its ends, and last 0, where an effect is gone."""
    own = Bounds.read(domain)
    ends = [end for end in (own.high, own.low) if end is not None]
    inside = (Fraction(f"{float(sum(ends)) / 2:.2g}"), *_PLAIN, *(end / 2 for end in ends))
    yield from (x for x in dict.fromkeys((*(x for x in inside if x not in (0, *ends)), *filter(None, ends), Fraction(0))) if own.holds(x))
