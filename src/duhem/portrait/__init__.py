"""What does K look like?  Sections with normals, seams, slips and the witness of what is refuted, drawn as they were computed."""

from duhem.portrait.pictures import plot

__all__ = ["plot"]
