"""Routines that some laws do not survive, in a module that another process can import."""

import os
import sys

import numpy as np

from duhem.testing import Step


def right(trial, pressure, stiffness):
    """The closest point of a disc of radius -0.3 sigma_n, for any multiple of one stiffness."""
    return radial(trial, 0.3 * np.abs(pressure))


def radial(trial, radius):
    size = np.linalg.norm(trial, axis=1)
    return trial * np.where(size > radius, radius / np.where(size > 0.0, size, 1.0), 1.0)[:, None]


def raises(trial, pressure, stiffness):
    raise ValueError("no")


FIRST = []


def keeps(trial, pressure, stiffness, mu):
    """Right for the friction that it is called with first, which it keeps."""
    FIRST.append(mu)
    return radial(trial, FIRST[0] * np.abs(pressure))


class Speechless(BaseException):
    def __str__(self):
        raise ValueError("no words")


def ends(trial, pressure, stiffness, mu):
    """The same where mu is open, and by its value an end of another kind."""
    print("printed")
    os.write(1, b"printed")
    match round(10.0 * mu):
        case 1:
            while True:
                pass
        case 2:
            bytearray(40 * 10**9)
        case 4:
            os._exit(3)
        case 5:
            sys.exit(5)
        case 6:
            raise KeyboardInterrupt
        case 11:
            raise GeneratorExit
        case 12:
            raise Speechless
        case 13:
            raise MemoryError
        case 7:
            return Step(trial, solved=np.zeros(len(trial), dtype=bool))
    return radial(trial, mu * np.abs(pressure))
