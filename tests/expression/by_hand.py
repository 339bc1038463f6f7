"""One formula for each node class, with that node at its root, and its value by hand."""

from __future__ import annotations

import sympy as sp

from duhem.expression import Atan2, EigMax, Neg, Norm, Pos, Where, symbol

__all__ = ["AT", "ROWS", "x", "y"]

x, y = symbol("x"), symbol("y")

AT = {x: -3.0, y: 4.0}
ROWS: dict[type, tuple[sp.Expr, float]] = {
    sp.Add: (x + y + 2, 3.0),
    sp.Mul: (x * y / 2, -6.0),
    sp.Pow: (y ** sp.Rational(3, 2), 8.0),
    sp.Abs: (sp.Abs(x), 3.0),
    sp.exp: (sp.exp(x), 0.049787068367863944),
    sp.log: (sp.log(y), 1.3862943611198906),
    sp.sin: (sp.sin(y), -0.7568024953079282),
    sp.cos: (sp.cos(y), -0.6536436208636119),
    sp.tan: (sp.tan(y), 1.1578212823495775),
    sp.asin: (sp.asin(x / 4), -0.848062078981481),
    sp.acos: (sp.acos(x / 4), 2.4188584057763776),
    Atan2: (Atan2(y, x), 2.214297435588181),
    sp.sinh: (sp.sinh(x), -10.017874927409903),
    sp.cosh: (sp.cosh(x), 10.067661995777765),
    sp.tanh: (sp.tanh(x), -0.9950547536867305),
    sp.atan: (sp.atan(y), 1.3258176636680326),
    sp.Min: (sp.Min(x, y, 2), -3.0),
    sp.Max: (sp.Max(x, y, 2), 4.0),
    Pos: (Pos(y), 4.0),
    Neg: (Neg(x), 3.0),
    Norm: (Norm(x, y, sp.Integer(12)), 13.0),
    EigMax: (EigMax(x, y, 2, 0, 0, sp.Integer(12)), 13.0),
    Where: (Where(x > -3, x, y), 4.0),
    sp.StrictGreaterThan: (y > x, 1.0),
    sp.GreaterThan: (x >= y, 0.0),
    sp.StrictLessThan: (x < y, 1.0),
    sp.LessThan: (y <= x, 0.0),
}
