"""An inquiry that some rows do not survive, in a module that another process can import."""

import os
import subprocess
import time
from dataclasses import dataclass

NAMES = ("alive", "well")


@dataclass(frozen=True)
class Poison:
    """What happens to coulomb where mu is one of these, and nothing elsewhere."""

    crash: int = 0
    hang: int = 0
    memory: int = 0
    fault: int = 0
    sleep: int = 0
    fork: int = 0
    names: tuple[str, ...] = NAMES
    options: tuple[str, ...] = ()
    alone: bool = False

    def told(self):
        return repr(self)

    def answers(self, law):
        verdict = "proved"
        match int(law.parameters["mu"].value):
            case self.crash:
                os.abort()
            case self.hang:
                while True:
                    pass
            case self.sleep:
                subprocess.run(["sleep", "600"])
            case self.fork:
                if os.fork():
                    time.sleep(0.3)
                else:
                    verdict = "refuted"  # and first
            case self.memory:
                bytearray(40 * 10**9)
            case self.fault:
                raise ZeroDivisionError("by mu")
        for name in reversed(self.names):
            yield name, verdict, "by hand", None, None, 1, 0.5
