"""Every sentence beside the verdicts, of sets of known kind, against a truth that comes from how the set was made.

A set is made in coordinates y, which are combinations of the forces: its g is a gauge of some of the y, compared with a size.  So it
is known what K is (nothing, everything, a point, a line, without inside, unbounded in so many directions), and g is known as a function
of Python's floats beside the text that duhem is given.  What is printed is read by the table ``ROWS``; a sentence without a row counts
as untrue.  A law may have a flow of its own, which changes nothing about K.

    python -m tests.campaigns.remarks --sets 1000 --seed 1
"""

from __future__ import annotations

import argparse
import math
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random
from typing import Any

from duhem import POSITIVE, Criterion, Domain, verify

__all__ = ["ROWS", "Case", "drawn", "faults", "tensors"]

Values = Mapping[str, float]
Function = Callable[[Values], float]


@dataclass(frozen=True)
class Case:
    """A law with what is true of it for every parameter value and pressure.

    ``dim`` is that of K where it is a subspace or a shift of one; ``centred`` where it holds zero force.  ``flat`` is the number of
    directions in which g does not change; ``undefined`` tells where it has no value.
    """

    kind: str
    law: Criterion
    g: Function
    parameters: tuple[Values, ...]
    flat: int
    empty: bool = False
    everything: bool = False
    thin: bool = False
    dim: int | None = None
    centred: bool = True
    undefined: Callable[[Values], bool] = field(default=lambda _: False)

    @property
    def vacuous(self) -> bool:
        """Whether K has no boundary point but 0."""
        return self.empty or self.everything or (self.dim == 0 and self.centred)


# -- what a sentence says, and whether it is true ------------------------------------------------------------------------


def _bends(case: Case, places: list[Values]) -> bool:
    """Whether the slopes on either side of each place differ in some direction: the second difference falls no faster than the step."""
    rng = Random(3)
    ways = [[rng.uniform(-1, 1) for _ in case.law.forces] for _ in range(6)]

    def gap(at: Values, way: Sequence[float], h: float) -> float:
        moved = [dict(at) | {x: at[x] + side * h * w for x, w in zip(case.law.forces, way, strict=True)} for side in (1, -1)]
        return abs(sum(map(case.g, moved)) - 2 * case.g(at)) / h

    return all(any(gap(at, way, 1e-5) > max(1e-6, 0.5 * gap(at, way, 1e-3)) for way in ways) for at in places)


def _places(case: Case, said: str) -> list[Values]:
    """The place at several parameter values, other forces in it at any value."""
    found, rng = list[Values](), Random(4)
    for values in case.parameters:
        at = dict.fromkeys(case.law.forces, 0.0)
        if said != "zero force":
            equal = dict(part.split(" = ") for part in said.split(", "))
            at |= {x: rng.uniform(-2, 2) for x in case.law.forces if x not in equal}
            names = {**values, **at, "abs": abs, "sqrt": math.sqrt, "pi": math.pi}
            at |= {x: float(eval(text, {}, names)) for x, text in equal.items()}
        found.append({**values, **at})
    return found


def _singular(case: Case, place: str, inside: str | None) -> bool:
    places = _places(case, place)
    return _bends(case, places) and (inside is None or all(case.g(at) < 0 for at in places))


def _along(case: Case, said: str) -> bool:
    ray = dict(part.split(" = ") for part in said.split(", "))
    sense = {"t": 1.0, "-t": -1.0, "0": 0.0}
    points = ({**v, **{x: sense[ray[x]] * t for x in case.law.forces}} for v in case.parameters for t in (1e-6, 1e-2, 1.0, 30.0, 1e4, 1e7))
    return all(case.g(point) <= 1e-9 * max(1.0, *(abs(point[x]) for x in case.law.forces)) for point in points)


def _idle(case: Case, name: str) -> bool:
    """Whether g is the same at other values of a name."""
    rng, others = Random(6), (-0.4, -3.0) if name == case.law.pressure else (0.4, 3.0)
    for values in case.parameters:
        at = {**values, **{x: rng.uniform(-2, 2) for x in case.law.forces}}
        if any(abs(case.g({**at, name: other}) - case.g(at)) > 1e-9 for other in others):
            return False
    return True


def _nowhere(case: Case, said: str) -> bool:
    """g has no value where a linear form is 0, or at zero force."""
    if said == "at zero force":
        return all(case.undefined({**v, **dict.fromkeys(case.law.forces, 0.0)}) for v in case.parameters)
    return all(case.undefined({**v, **dict.fromkeys(case.law.forces, 1.7), said: 0.0}) for v in case.parameters)


Row = tuple[str, Callable[[Case, Any], bool]]
_INSIDE = r"(; (?:that point is|those points are) inside K(?: for \w+ < 0)?, so the boundary is not touched)?"
ROWS: tuple[Row, ...] = (
    (r"The claims about .+ hold at every frozen value of .+", lambda case, _: bool(case.law.variables)),
    (r"Normality says nothing of the variables without a force: .+", lambda case, _: bool(case.law.variables)),
    (
        r"psi is separately convex: in each variable(?: but the temperature)? alone, at every value of the others",
        lambda case, _: case.law.energy is not None,
    ),
    (r"K is empty: g > 0 for all forces(?: \(\w+ <= 0 in compression: write abs\(\w+\)\))?", lambda case, _: case.empty),
    (r"K contains all forces: g <= 0 everywhere", lambda case, _: case.everything),
    (r"K is the point 0: g > 0 elsewhere", lambda case, _: case.dim == 0 and case.centred),
    (r"K is a line without interior points: g > 0 elsewhere", lambda case, _: case.dim == 1),
    (r"K is a space of (\d+) dimensions without interior points: g > 0 elsewhere", lambda case, m: case.dim == int(m[1])),
    (r"K has no interior points: g >= 0 for all forces, and g = 0 in K", lambda case, _: case.thin),
    (
        r"K is unbounded: g does not change along (\d+) directions? of the forces",
        lambda case, m: case.flat == int(m[1]) and not case.empty,
    ),
    (
        r"K is unbounded: g does not change along at least (\d+) directions? of the forces",
        lambda case, m: case.flat >= int(m[1]) and not case.empty,
    ),
    (r"K is unbounded: g <= 0 at (.*) for all t > 0", lambda case, m: _along(case, m[1])),
    (rf"g is not differentiable at (.*?){_INSIDE}", lambda case, m: _singular(case, m[1], m[2])),
    (r"g does not depend on (.*)", lambda case, m: all(_idle(case, name) for name in m[1].split(", "))),
    (
        r"g has no value (at zero force): it .*, which is 0 there; duhem uses the limit of g there, and K is closed",
        lambda case, m: _nowhere(case, m[1]),
    ),
    # what is not shown, and said to be so
    (
        r"duhem could not show that g has a value for all forces: it .*\. (?:g has no value .*\. )?"
        r"(?:Where g is 0/0 and has a limit, duhem uses this limit, because K is closed\. |"
        r"A point where g has no value does not belong to K\. )"
        r"For such a formula, duhem reports only proofs that the kernel confirms",
        lambda case, _: case.kind == "quotient",
    ),
    (
        r"duhem could not show that the flow has a value on the whole boundary: it .*\. "
        r"For such a flow, duhem reports only proofs that the kernel confirms",
        lambda case, _: not case.law.associated,
    ),
    (r"The flow has no value at .*: it .*\. For such a flow, duhem reports only proofs that the kernel confirms", lambda case, _: False),
    (r"\w+: .* proved it and .* refutes it at .*: this is a defect of duhem, please report it", lambda case, _: False),
)


def faults(case: Case, said: Sequence[str], vacuous: bool) -> list[str]:
    """The sentences that are untrue of the set, or have no row."""
    found = [] if case.vacuous or not vacuous else ["vacuous"]
    for sentence in said:
        reading = next(((match, true) for text, true in ROWS if (match := re.fullmatch(text, sentence))), None)
        if reading is None or not reading[1](case, reading[0]):
            found.append(sentence)
    return found


# -- sets of known kind --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Size:
    """What a gauge is compared with: its text, its value, and the values of names at which it is looked at."""

    text: str
    of: Function
    declared: Mapping[str, Domain]
    values: tuple[Values, ...]
    pressure: str | None = None

    @property
    def positive(self) -> bool:
        return all(self.of(v) > 0 for v in self.values)


_SIZES = (
    _Size("3/2", lambda _: 1.5, {}, ({},)),
    _Size("r", lambda v: v["r"], {"r": POSITIVE}, ({"r": 0.1}, {"r": 1.0}, {"r": 40.0})),
    _Size("r", lambda v: v["r"], {"r": Domain.between(1, 2)}, ({"r": 1.0}, {"r": 2.0})),
    _Size("r", lambda v: v["r"], {"r": Domain.between(0, 1)}, ({"r": 0.0}, {"r": 1.0})),
    _Size("mu*abs(n)", lambda v: -v["mu"] * v["n"], {"mu": POSITIVE}, ({"mu": 0.3, "n": -1.0}, {"mu": 2.0, "n": -5.0}), "n"),
    _Size(
        "(c - mu*n)",
        lambda v: v["c"] - v["mu"] * v["n"],
        {"mu": POSITIVE, "c": Domain.between(0)},
        ({"mu": 0.3, "c": 0.0, "n": -1.0},),
        "n",
    ),
)
Gauge = tuple[Callable[[Sequence[str]], str], Callable[[Sequence[float]], float]]


def _gauges(k: int) -> list[Gauge]:
    """Of k coordinates: >= 0, and 0 where all of them are 0 alone."""
    squares = lambda y: " + ".join(f"{x}**2" for x in y)  # noqa: E731
    total = lambda y: sum(x * x for x in y)  # noqa: E731
    return [
        (lambda y: f"norm({', '.join(y)})" if k > 1 else f"abs({y[0]})", lambda y: math.sqrt(total(y))),
        (lambda y: f"sqrt({squares(y)})", lambda y: math.sqrt(total(y))),
        (lambda y: f"({squares(y)})", total),
        (lambda y: f"({squares(y)})**(3/4)", lambda y: total(y) ** 0.75),
        (lambda y: f"({' + '.join(f'abs({x})' for x in y)})", lambda y: sum(map(abs, y))),
        (lambda y: f"max({', '.join(f'abs({x})' for x in y)})" if k > 1 else f"abs({y[0]})", lambda y: max(map(abs, y))),
        (lambda y: f"({' + '.join(f'{x}**4' for x in y)})", lambda y: sum(x**4 for x in y)),
        (lambda y: f"(sqrt({squares(y)} + 1) - 1)", lambda y: total(y) / (math.sqrt(total(y) + 1) + 1)),
        (lambda y: f"(max({', '.join(f'{x}, -{x}' for x in y)}))", lambda y: max(map(abs, y))),
        (lambda y: f"norm({', '.join(f'pos({x}) + 2*neg({x})' for x in y)})" if k > 1 else f"(pos({y[0]}) + 2*neg({y[0]}))",
         lambda y: math.sqrt(sum((max(x, 0) + 2 * max(-x, 0)) ** 2 for x in y))),
    ]  # fmt: skip


@dataclass(frozen=True)
class _Frame:
    """Coordinates y = M x - centre, of which the first ``k`` stand in g."""

    forces: tuple[str, ...]
    rows: tuple[tuple[int, ...], ...]
    centre: tuple[int, ...]

    def texts(self) -> list[str]:
        """Each coordinate in the forces."""
        found = []
        for row, c in zip(self.rows, self.centre, strict=True):
            terms = " + ".join(x if m == 1 else f"({m})*{x}" for m, x in zip(row, self.forces, strict=True) if m)
            found.append(f"({terms}{f' - ({c})' if c else ''})")
        return found

    def at(self, v: Values) -> list[float]:
        """Their values."""
        return [sum(m * v[x] for m, x in zip(row, self.forces, strict=True)) - c for row, c in zip(self.rows, self.centre, strict=True)]


def _frame(rng: Random, n: int, k: int) -> _Frame:
    """k independent combinations of n forces."""
    while True:
        if rng.random() < 0.5:
            chosen = rng.sample(range(n), k)
            rows = tuple(tuple(int(i == j) for j in range(n)) for i in chosen)
        else:
            rows = tuple(tuple(rng.choice((-1, 0, 0, 1, 2)) for _ in range(n)) for _ in range(k))
        if _rank([list(map(float, row)) for row in rows]) == k:
            centre = tuple(rng.choice((-1, 1, 2)) for _ in range(k)) if rng.random() < 0.25 else (0,) * k
            return _Frame(tuple(f"x{i}" for i in range(1, n + 1)), rows, centre)


def _rank(rows: list[list[float]]) -> int:
    rank = 0
    for j in range(len(rows[0])):
        pivot = next((row for row in rows if abs(row[j]) > 1e-9), None)
        if pivot is not None:
            rank += 1
            rows = [[a - b * row[j] / pivot[j] for a, b in zip(row, pivot, strict=True)] for row in rows if row is not pivot]
    return rank


def _of_a_gauge(rng: Random) -> Case:
    n = rng.choice((1, 2, 2, 2, 3, 3, 4, 5, 6))
    k = rng.choice((n, n, rng.randint(1, n)))
    frame, size, (text_of, value_of) = _frame(rng, n, k), rng.choice(_SIZES), rng.choice(_gauges(k))
    y, gauge, s = frame.texts(), text_of(frame.texts()), size.text
    centred = not any(frame.centre)
    flat = n - k

    def q(v: Values) -> float:
        return value_of(frame.at(v))

    kinds: dict[str, tuple[str, Function, dict[str, Any]]] = {
        "inside": (f"{gauge} - {s}", lambda v: q(v) - size.of(v), {}),
        "ramp": (f"pos({gauge} - {s})", lambda v: max(q(v) - size.of(v), 0), {}),
        "greater": (f"max(0, {gauge} - {s})", lambda v: max(q(v) - size.of(v), 0), {}),
        "least": (gauge, q, {"dim": flat, "centred": centred, "thin": True}),
        "multiple": (f"3*{gauge} + ({gauge})**2", lambda v: 3 * q(v) + q(v) ** 2, {"dim": flat, "centred": centred, "thin": True}),
        "empty": (f"{gauge} + {s}", lambda v: q(v) + size.of(v), {"empty": size.positive, "thin": True}),
        "everything": (f"-({gauge}) - {s}", lambda v: -q(v) - size.of(v), {"everything": True}),
        "shell": (f"abs({gauge} - {s})", lambda v: abs(q(v) - size.of(v)), {"thin": True}),
        "squared": (f"({gauge} - {s})**2", lambda v: (q(v) - size.of(v)) ** 2, {"thin": True}),
        "outside": (f"{s} - {gauge}", lambda v: size.of(v) - q(v), {"everything": False}),
        "half": (f"{y[0]} - {s}", lambda v: frame.at(v)[0] - size.of(v), {"flat": n - 1}),
        "slab": (f"max({y[0]}, {gauge} - {s})", lambda v: max(frame.at(v)[0], q(v) - size.of(v)), {}),
        "piece": (f"max(abs({y[0]}), {gauge} - {s})", lambda v: max(abs(frame.at(v)[0]), q(v) - size.of(v)), {"thin": True}),
        "two": (f"{gauge} + norm({', '.join(y)}, {s})/2 - {s}",
                lambda v: q(v) + math.hypot(*frame.at(v), size.of(v)) / 2 - size.of(v), {}),
        "cone": (f"{gauge} - {y[0]}", lambda v: q(v) - frame.at(v)[0], {}),
        "valley": (f"{gauge} - {s}*{y[0]}", lambda v: q(v) - size.of(v) * frame.at(v)[0], {}),
    }  # fmt: skip
    kind = rng.choice(list(kinds))
    text, g, truth = kinds[kind]
    if kind == "piece" and k == 1:  # of one coordinate nothing but 0 is left
        truth |= {"dim": flat, "centred": centred}
    flow = tuple(f"{x} + 1" for x in frame.forces) if rng.random() < 0.3 else None
    law = Criterion("law", text, dict(size.declared), frame.forces, size.pressure, flow=flow)
    truth = {"flat": flat, **truth}
    return Case(kind, law, g, size.values, **truth)


def _tips(rng: Random) -> Case:
    """Two or three norms about points in the plane: tips in K, on its boundary and outside."""
    points = [(0, 0), (rng.randint(1, 3), 0), (rng.randint(-2, 2), rng.randint(1, 3))][: rng.randint(1, 3)]
    weights = [rng.choice((1, 2, 3)) for _ in points]
    reach = math.hypot(*points[-1]) * sum(weights) if rng.random() < 0.4 and len(points) < 3 else rng.randint(1, 9)
    size = f"{int(reach)}" if reach and float(reach).is_integer() else "4"
    text = " + ".join(f"{w}*norm(x1 - ({p}), x2 - ({q}))" for w, (p, q) in zip(weights, points, strict=True)) + f" - {size}"

    def g(v: Values) -> float:
        return sum(w * math.hypot(v["x1"] - p, v["x2"] - q) for w, (p, q) in zip(weights, points, strict=True)) - float(size)

    flow = ("x1", "x2") if rng.random() < 0.3 else None
    law = Criterion("law", text, {}, ("x1", "x2"), None, flow=flow)
    least = _least(lambda x: _least(lambda y: g({"x1": x, "x2": y})))
    alone = weights[0] > sum(weights[1:]) and g({"x1": 0.0, "x2": 0.0}) == 0  # the first norm outweighs the others: K is its point
    return Case("tips", law, g, ({},), 0, empty=least > 1e-9, thin=abs(least) <= 1e-9, dim=0 if alone else None)


def _least(f: Callable[[float], float]) -> float:
    """The least value of a convex function between -4 and 4, by thirds."""
    low, high = -4.0, 4.0
    for _ in range(80):
        one, two = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, two) if f(one) < f(two) else (one, high)
    return f((low + high) / 2)


def _quotient(rng: Random) -> Case:
    """g without a value at zero force, or where a force is 0, and with a limit there."""
    c = rng.choice(("1/4", "1/10", "1/3"))
    share = float(int(c[0]) / int(c[2:]))
    if rng.random() < 0.5:
        text = f"norm(x1, x2) + {c}*x1*x2/norm(x1, x2) - 1"
        return Case(
            "quotient",
            Criterion("law", text, {}, ("x1", "x2"), None),
            lambda v: (r := math.hypot(v["x1"], v["x2"])) + share * v["x1"] * v["x2"] / r - 1,
            ({},),
            0,
            undefined=lambda v: v["x1"] == v["x2"] == 0,
        )
    k = rng.choice((2, 4))
    text = f"norm(x1, x2) - (1 + {c}/4*cos({k}*atan(x2/x1)))"
    return Case(
        "quotient",
        Criterion("law", text, {}, ("x1", "x2"), None),
        lambda v: math.hypot(v["x1"], v["x2"]) - 1 - share / 4 * math.cos(k * math.atan2(v["x2"], v["x1"])),
        ({},),
        0,
        undefined=lambda v: v["x1"] == 0,
    )


_SHEARS = {"3d": ("yz", "xz", "xy"), "plane": ("xy",), "principal": ()}


def tensors() -> Iterator[Case]:
    """Of a stress in three kinds: functions of its invariants, with and without a potential of another kind."""
    for kind in ("3d", "plane", "principal"):
        d = {"3d": 6, "plane": 3, "principal": 3}[kind]
        pressure = 0 if kind == "plane" else 1  # the deviator does not change along the pressure; in plane stress it does

        def mean(v: Values, kind: str = kind) -> float:
            return sum(v[x] for x in ("s_xx", "s_yy", "s_zz", "s_1", "s_2", "s_3") if x in v)

        def j2(v: Values, kind: str = kind) -> float:
            one, two, three = (v["s_1"], v["s_2"], v["s_3"]) if kind == "principal" else (v["s_xx"], v["s_yy"], v.get("s_zz", 0.0))
            shears = sum(v[f"s_{x}"] ** 2 for x in _SHEARS[kind])
            return ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2) / 6 + shears

        forms: list[tuple[str, Function, dict[str, Any]]] = [
            ("J2(s) - c", lambda v, j2=j2: j2(v) - v["c"], {"flat": pressure}),
            ("sqrt(J2(s)) - c", lambda v, j2=j2: math.sqrt(j2(v)) - v["c"], {"flat": pressure}),
            ("J2(s) + I1(s)**2 - c", lambda v, j2=j2, mean=mean: j2(v) + mean(v) ** 2 - v["c"], {"flat": 0}),
            ("sqrt(3*J2(s)) + I1(s)/5 - c", lambda v, j2=j2, mean=mean: math.sqrt(3 * j2(v)) + mean(v) / 5 - v["c"], {"flat": 0}),
            ("I1(s) - c", lambda v, mean=mean: mean(v) - v["c"], {"flat": d - 1}),
            ("J2(s) + c", lambda v, j2=j2: j2(v) + v["c"], {"flat": pressure, "empty": True}),
            ("J2(s) + 0*c", lambda v, j2=j2: j2(v), {"flat": pressure, "dim": pressure, "thin": True}),
            ("I1(s)**2 + 0*c", lambda v, mean=mean: mean(v) ** 2, {"flat": d - 1, "dim": d - 1, "thin": True}),
            ("J2(s) + I1(s)**2 + 0*c", lambda v, j2=j2, mean=mean: j2(v) + mean(v) ** 2, {"flat": 0, "dim": 0, "thin": True}),
            ("max(0, J2(s) - c)", lambda v, j2=j2: max(0.0, j2(v) - v["c"]), {"flat": pressure}),
            ("-J2(s) - c", lambda v, j2=j2: -j2(v) - v["c"], {"flat": pressure, "everything": True}),
        ]
        for potential in (None, "J2(s)", "J2(s) + I1(s)**2"):
            for text, g, truth in forms:
                law = Criterion("law", text, {"c": POSITIVE}, pressure=None, stress={"name": "s", "kind": kind}, potential=potential)  # type: ignore[arg-type]
                yield Case(f"{kind} {text}", law, g, ({"c": 0.5}, {"c": 3.0}), **truth)


def drawn(sets: int, seed: int) -> Iterator[Case]:
    """So many sets; every kind of tensor once among 300."""
    rng = Random(seed)
    whole = list(tensors())
    for i in range(sets):
        if i % 4 == 3:
            yield whole[rng.randrange(len(whole))] if sets < 4 * len(whole) else whole[i // 4 % len(whole)]
        else:
            yield (_tips if i % 12 == 1 else _quotient if i % 40 == 2 else _of_a_gauge)(rng)


def _missing(case: Case, said: Sequence[str]) -> str:
    """What could have been said of a set and was not."""
    everything = " ".join(said)
    wanted = {"empty": case.empty, "everything": case.everything, "without inside": case.dim is not None and case.dim > 0 and case.centred}
    return ", ".join(what for what, true in wanted.items() if true and what not in everything)


def main() -> None:
    """Draws the sets, asks for the remarks and prints what is untrue."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    begun, kinds, sentences, untrue, unsaid = time.perf_counter(), Counter[str](), 0, 0, Counter[str]()
    for case in drawn(asked.sets, asked.seed):
        found = verify(replace(case.law), claims=["origin"])
        kinds[case.kind] += 1
        sentences += len(found.remarks)
        if missing := _missing(case, found.remarks):
            unsaid[f"{case.kind}: {missing}"] += 1
        for fault in faults(case, found.remarks, found.vacuous):
            untrue += 1
            print(f"UNTRUE of {case.kind}: {case.law.g}, flow {case.law.flow}, {dict(case.law.parameters)}:\n    {fault}", flush=True)
    print(f"{sum(kinds.values())} sets of {len(kinds)} kinds, {sentences} sentences, {untrue} untrue, {time.perf_counter() - begun:.0f} s")
    print("not said, though true:", dict(unsaid))


if __name__ == "__main__":
    main()
