"""Limit points of known laws, and what is known of a fit to them."""

import numpy as np

from duhem.expression.numpy_ import compiled

__all__ = ["NAMES", "PAPER", "design", "information", "on_boundary", "rays", "table", "values"]

NAMES = ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")
PAPER = np.array([0.2, 0.08, 0.12, 0.15])


def quarters(mu, angle):
    """Half-axes (m, 2) of the quarter ellipses that the eccentric angles (m,) lie on, and which coefficients they are."""
    which = np.stack([np.where(np.cos(angle) >= 0, 0, 1), np.where(np.sin(angle) >= 0, 2, 3)], axis=1)
    return np.asarray(mu)[which], which


def on_boundary(mu, angle, pressure):
    """Limit points (m, 2) of Eq. (35) at eccentric angles."""
    axes, _ = quarters(mu, angle)
    return axes * np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.abs(pressure)[:, None]


def information(mu, angle, pressure, scatter):
    """Fisher information from the parametric form: moving mu_k moves the point, and only what is normal to the curve tells."""
    axes, which = quarters(mu, angle)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    normal = direction / axes
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rows = np.zeros((len(angle), 4))
    for i in range(2):
        rows[np.arange(len(angle)), which[:, i]] = normal[:, i] * direction[:, i] * np.abs(pressure)
    return (rows / np.square(scatter)[:, None]).T @ rows


def design(m, seed):
    draw = np.random.default_rng(seed)
    return np.linspace(0.0, 2.0 * np.pi, m, endpoint=False) + 0.03, -draw.uniform(0.5e6, 2e6, m)


def table(mu, m=32, seed=0, noise=0.0):
    angle, pressure = design(m, seed)
    errors = noise * np.random.default_rng(seed + 1).standard_normal((m, 2))
    return np.column_stack([on_boundary(mu, angle, pressure) + errors, pressure])


def values(done):
    return np.array([done.coefficients[n] for n in NAMES])


def rays(law, parameters, m, seed):
    """Limit points of any law by bisection of g along random rays."""
    draw, table_ = np.random.default_rng(seed), law.symbols()
    g = compiled(law.g, list(table_.values()))
    u = draw.standard_normal((m, len(law.forces)))
    u -= u.mean(axis=1, keepdims=True) if len(law.forces) == 3 else 0.0
    u /= np.linalg.norm(u, axis=1)[:, None]
    pressure = [-draw.uniform(1.0, 3.0, m)] if law.pressure else []
    low, high = np.full(m, 1e-6), np.full(m, 50.0)
    for _ in range(80):
        middle = 0.5 * (low + high)
        inside = g(*(u * middle[:, None]).T, *pressure, *(np.full(m, parameters[n]) for n in law.parameters)) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.column_stack([u * low[:, None], *pressure])
