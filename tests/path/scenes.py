"""Scenes of paths of chance, as several tests and campaigns run them."""

__all__ = ["TABLE", "walk"]

TABLE = '[points]\ntable = "points.csv"\n\n'  # of many points: what is each point's own


def walk(points: int, own: str = "", *, law: str = "antoni2007", **parameters: float) -> str:
    """A scene that ends within its section [path], over as many ``points``."""
    given = "".join(f"{name} = {value}\n" for name, value in parameters.items())
    return f"""\
law = "{law}"
stiffness = [1.0, 2.0]

[parameters]
{given}
{own}[path]
kind = "random"
seed = 3
points = {points}
scale = 0.3
"""
