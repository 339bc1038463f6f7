"""How names and numbers are written in formulas, on paper and on figures alike."""

from __future__ import annotations

__all__ = ["latex_name", "latex_number"]

_GREEK = {
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi", "pi", "rho",
    "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi",
    "Psi", "Omega",
}  # fmt: skip


def latex_name(name: str) -> str:
    """``mu_a_plus`` as mu with index a and exponent +; Greek names as letters; other words upright."""
    head, *rest = name.split("_")
    digits = head.lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
    if digits.isdigit():
        head, rest = head[: -len(digits)], [digits, *rest]
    sign = {"plus": "+", "minus": "-"}.get(rest[-1]) if rest else None
    rest = rest[:-1] if sign else rest
    base = f"\\{head}" if head in _GREEK else head if len(head) == 1 else rf"\mathrm{{{head}}}"
    inner = ",".join(r if r.isdigit() or len(r) == 1 else rf"\mathrm{{{r}}}" for r in rest)
    index = f"_{{{inner}}}" if inner else ""
    return base + index + (f"^{{{sign}}}" if sign else "")


def latex_number(x: float, digits: int = 4) -> str:
    """``x`` to some digits; where those need a power of ten, as one."""
    mantissa, _, power = f"{x:.{digits}g}".partition("e")
    if not power:
        return mantissa
    factor = {"1": "", "-1": "-"}.get(mantissa, rf"{mantissa} \cdot ")
    return f"{factor}10^{{{int(power)}}}"
