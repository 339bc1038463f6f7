"""The slipping stress over straight steps in 30 digits, by Gauss collocation of order 24 in the plane of the stresses.

It shares nothing with the package: no angle, no closed form; the flow rule, the consistency condition and the quadrants as
they stand in the criterion, with slip, seams and the end of sticking found as roots.
"""

from itertools import pairwise

from mpmath import MPContext

mp = MPContext()
mp.dps = 34  # 30 digits and what rounding takes
STAGES = 12


def _collocation():
    starts = [mp.cos(mp.pi * (4 * i + 3) / (4 * STAGES + 2)) for i in range(STAGES)]
    nodes = [(1 + mp.findroot(lambda x: mp.legendre(STAGES, x), (x, x + mp.mpf(10) ** -6))) / 2 for x in starts]
    powers = mp.matrix(STAGES, STAGES)
    for i in range(STAGES):
        for j in range(STAGES):
            powers[i, j] = nodes[j] ** i
    inverse = powers**-1

    def integral(to):
        return [sum(inverse[j, i] * to ** (i + 1) / (i + 1) for i in range(STAGES)) for j in range(STAGES)]

    top = [1 / mp.fprod(c - other for other in nodes if other != c) / mp.mpf(4) ** (STAGES - 1) for c in nodes]
    return [integral(c) for c in nodes], integral(mp.mpf(1)), top


TABLE, WEIGHTS, TOP = _collocation()  # TOP: what of the slopes lies in their highest power, about the error of interpolation
TINY = mp.mpf(10) ** -27


def drive(points, mu, load, k):
    """Stress, multiplier, dissipation and work after each of the straight steps through ``points``, from zero stress."""
    mu, k = [mp.mpf(float(x)) for x in mu], [mp.mpf(float(x)) for x in k]
    load = mp.mpf(float(load))
    points = [[mp.mpf(float(x)) for x in p] for p in points]
    state = [mp.mpf(0)] * 4  # two stresses, multiplier, work
    rows = []
    for a, b in pairwise(points):
        state = _segment(state, [y - x for x, y in zip(a, b, strict=True)], mu, load, k)
        rows.append((state[:2], state[2], load * state[2], state[3]))
    return rows


def _side(s, du, mu):
    return [mu[2 * i + (1 if (s[i] < 0 or (s[i] == 0 and du[i] < 0)) else 0)] for i in (0, 1)]


def _segment(state, du, mu, load, k):
    time = mp.mpf(0)
    s = state[:2]
    q = [k[0] * du[0], k[1] * du[1]]

    def gauge(s):
        return mp.hypot(*(s[i] / mu[2 * i + (1 if s[i] < 0 else 0)] for i in (0, 1)))

    def at(tau):
        return [s[0] + tau * q[0], s[1] + tau * q[1]]

    m = _side(s, du, mu)
    outward = sum(s[i] / m[i] ** 2 * q[i] for i in (0, 1))
    if gauge(s) < load * (1 - mp.mpf(10) ** -25) or outward <= 0:
        if gauge(at(1)) <= load:
            return [*at(1), state[2], state[3] + sum((s[i] + q[i] / 2) * du[i] for i in (0, 1))]
        low, high = mp.mpf(0), mp.mpf(1)
        if outward <= 0:  # step inside first: K is convex, the chord comes out once
            low = -outward / sum(q[i] ** 2 / m[i] ** 2 for i in (0, 1)) / 1000
        for _ in range(100):
            middle = (low + high) / 2
            low, high = (middle, high) if gauge(at(middle)) < load else (low, middle)
        time = (low + high) / 2
        state = [*at(time), state[2], state[3] + time * sum((s[i] + time * q[i] / 2) * du[i] for i in (0, 1))]
    step = mp.mpf(1) / 4
    while time < 1 - TINY:
        m = _side(state[:2], du, mu)
        signs = [1 if (x > 0 or (x == 0 and d >= 0)) else -1 for x, d in zip(state[:2], du, strict=True)]

        weights = [1 / x**2 for x in m]

        def rate(y, w=weights):
            n = [y[0] * w[0], y[1] * w[1]]  # the normal times the gauge
            kn = [k[0] * n[0], k[1] * n[1]]
            share = (n[0] * q[0] + n[1] * q[1]) / (n[0] * kn[0] + n[1] * kn[1])
            push = share * mp.sqrt(y[0] * n[0] + y[1] * n[1])
            return [q[0] - share * kn[0], q[1] - share * kn[1], push, y[0] * du[0] + y[1] * du[1]]

        def tried(h, rate=rate, state=state):
            return _collocated(rate, state, h)

        h = min(step, 1 - time)
        new = tried(h)
        while new is None:
            step = h = h / 2
            new = tried(h)
        crossed = [i for i in (0, 1) if new[i] * signs[i] < -TINY * load]
        if crossed:
            ends = []
            for i in crossed:
                low, high, f_low, f_high = mp.mpf(0), h, state[i] * signs[i], new[i] * signs[i]
                x = h * f_low / (f_low - f_high)
                for _ in range(100):  # regula falsi (Illinois)
                    f = tried(x)[i] * signs[i]
                    if abs(f) < TINY * load / 100:
                        break
                    if f > 0:
                        low, f_low, f_high = x, f, f_high / 2
                    else:
                        high, f_high, f_low = x, f, f_low / 2
                    x = (low * f_high - high * f_low) / (f_high - f_low)
                ends.append((x, i))
            h, i = min(ends)
            new = tried(h)
            new[i] = mp.mpf(0)
        time, state = time + h, new
        step = min(2 * step, mp.mpf(1))
    return state


def _collocated(rate, y, h):
    """One step by fixed-point iteration; None where it does not settle or is not resolved."""
    first = rate(y)
    slopes = [first] * STAGES
    change = mp.inf
    for _ in range(60):
        columns = [[f[c] for f in slopes] for c in range(2)]
        new = [rate([y[c] + h * mp.fdot(row, columns[c]) for c in range(2)]) for row in TABLE]
        before, change = change, max(abs(a[c] - b[c]) for a, b in zip(new, slopes, strict=True) for c in range(2))
        slopes = new
        scale = max(max(abs(x) for x in f[:2]) for f in slopes) + max(abs(x) for x in y[:2])
        if change <= TINY * scale:
            size = max(abs(h * x) for f in slopes for x in f[:2])
            bend = h * max(abs(sum(w * f[c] for w, f in zip(TOP, slopes, strict=True))) for c in range(2))
            if bend > mp.mpf(10) ** -11 * size + TINY * scale:  # the ends of the steps are good to about its square
                return None
            return [y[c] + h * sum(w * f[c] for w, f in zip(WEIGHTS, slopes, strict=True)) for c in range(4)]
        if change > before / 2 and change > TINY * 1000 * scale and before < mp.inf:
            return None
    return None
