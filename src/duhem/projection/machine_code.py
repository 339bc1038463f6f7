"""Machine code that numba has made, run without importing numba.

Importing numba and having it load a function that it kept takes longer than all else that a first increment does.  What it kept
is an object file, which llvmlite alone can load; what that calls is Python's, the C library's or that of numba's extension modules,
which are loaded by themselves.  So the same machine code runs, to the bit.

What is kept is found by the text, the kinds of the arguments and everything that the code was made with and for, and is sealed.  Where
anything is missing or other than expected there is none, and numba finds its own or compiles.
"""

from __future__ import annotations

import builtins
import ctypes
import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from duhem.projection import file_cache

__all__ = ["Kinds", "keep", "kept", "kinds", "place"]

Kinds = tuple[Any, ...]

_FLAGS = 0x1 | 0x2 | 0x400  # of an array in NumPy's C interface: whole by rows, whole by columns, to be written to
_EXTENSIONS = {"numba_": "numba._helperlib", "NRT_": "numba.core.runtime._nrt_python"}  # whose functions have names that begin so
_OTHER = AttributeError, ImportError, LookupError, OSError, RuntimeError, TypeError, ValueError  # another numba or llvmlite than is known


def kinds(arguments: Iterable[Any]) -> Kinds:
    """What compiled code is made for: arguments of equal kinds have one type in numba.  LookupError for one that is not known here."""
    return tuple([_kind(one) for one in arguments])


def _kind(one: Any) -> Any:
    if type(one) is np.ndarray:
        flags = one.flags.num & _FLAGS
        return one.dtype.str, one.ndim, flags & ~0x2 if flags & 0x1 else flags
    if type(one) is tuple:
        return tuple([_kind(each) for each in one])
    if type(one) is int and one.bit_length() > 63:
        raise LookupError
    return _SCALARS[type(one)]


_SCALARS = {float: "float", np.float64: "float", int: "int", bool: "bool"}


def place(text: Path, entry: str, known: Kinds) -> Path | None:
    """Where the code of ``entry`` of a text is kept for arguments of these kinds; None without numba or llvmlite."""
    made_with = _made_with()
    if made_with is None:
        return None
    digest = hashlib.sha256(repr((made_with, known)).encode()).hexdigest()
    return text.with_name(f"{text.stem}.{entry}.{digest[:32]}.o")


def keep(path: Path, compiled: Any, arguments: Iterable[Any]) -> None:
    """Keep what numba has compiled and kept for such arguments; nothing where it cannot be run without numba."""
    with suppress(*_OTHER):
        import numba

        made = compiled.overloads[tuple(map(numba.typeof, arguments))]
        own = compiled._cache
        (_, kind, (code, _)), described, environment, *_ = own._cache_file.load(own._index_key(made.signature.args, made.library.codegen))
        if kind != "object" or environment.consts:
            return
        names = {"function": described.llvm_cpython_wrapper_name, "environment": described.env_name, "calls": _undefined(code)}
        if not all(map(_address, names["calls"])):
            return
        file_cache.written(path, json.dumps(names).encode() + b"\n" + code)


def kept(path: Path, name: str) -> Callable[..., Any] | None:
    """The function that is kept there, ``name`` to Python; None where there is none that can be run."""
    content = file_cache.read(path)
    if content is None:
        return None
    head, _, code = content.partition(b"\n")
    with suppress(*_OTHER):
        return _loaded(code, json.loads(head), name)
    return None


def _loaded(code: bytes, names: Mapping[str, Any], name: str) -> Callable[..., Any] | None:
    """As numba loads it.  LLVM ends the process where a name has no address, hence the look at each of them before."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine()
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)  # from now on it knows the names in this process
    addresses = {call: _address(call) for call in names["calls"]}
    if not all(addresses.values()):
        return None
    for call, address in addresses.items():
        llvm.add_symbol(call, address)
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    begin, environment = engine.get_function_address(names["function"]), engine.get_global_value_address(names["environment"])
    if not (begin and environment):
        return None
    functions, holder = _extension("numba._dynfunc"), ModuleType(name)
    own = functions.Environment(holder.__dict__)
    ctypes.c_void_p.from_address(environment).value = id(own)
    run: Callable[..., Any] = functions.make_function(holder, name, "", begin, own, (engine,))
    return run


@cache
def _made_with() -> tuple[Any, ...] | None:
    """Everything that changes machine code, or what numba's extension modules are; None without them."""
    try:
        import llvmlite
        import llvmlite.binding as llvm

        library = Path(str(_found("numba._helperlib").origin))
        built = library.stat()
        own = library.with_name("_version.py").read_text("utf-8"), built.st_size, built.st_mtime_ns
        settings = sorted(each for each in os.environ.items() if each[0].startswith("NUMBA_"))
        processor = llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
        return own, llvmlite.__version__, np.__version__, sys.version, processor, settings
    except _OTHER:
        return None


def _extension(name: str) -> Any:
    """An extension module of numba, by itself: numba's own import finds it loaded."""
    if name not in sys.modules:
        spec = _found(name)
        module = module_from_spec(spec)
        assert spec.loader is not None
        spec.loader.exec_module(module)
    return sys.modules[name]


def _found(name: str) -> ModuleSpec:
    """Where a module of numba is, found without importing numba."""
    package = find_spec("numba")
    if package is not None and package.origin is not None:
        folder = Path(package.origin).parent.joinpath(*name.split(".")[1:-1])
        if (spec := PathFinder.find_spec(name, [str(folder)])) is not None:
            return spec
    raise ImportError(name)


def _address(name: str) -> int:
    """Where numba would tell LLVM to find ``name``; 0 where it is not known."""
    import llvmlite.binding as llvm

    if name == "_Py_NoneStruct":
        return id(None)
    if name.startswith("PyExc_"):
        return id(getattr(builtins, name.removeprefix("PyExc_")))
    for start, extension in _EXTENSIONS.items():
        if name.startswith(start):
            return int(_extension(extension).c_helpers.get(name.removeprefix(start), 0))
    return int(_extension("numba._helperlib").c_helpers.get(name, 0) or llvm.address_of_symbol(name) or 0)


def _undefined(code: bytes) -> list[str]:
    """The names that an object file takes from elsewhere.  ValueError where it is not ELF of 64 bits."""
    import llvmlite.binding as llvm

    if code[:6] != b"\x7fELF\x02\x01":
        raise ValueError("another kind of object file")
    sections = {each.name(): each.data() for each in llvm.object_file.ObjectFileRef.from_data(code).sections()}
    fields = [("name", "<u4"), ("info", "u1"), ("other", "u1"), ("section", "<u2"), ("value", "<u8"), ("size", "<u8")]
    symbols, strings = np.frombuffer(sections[b".symtab"], fields), sections[b".strtab"]
    starts = symbols["name"][(symbols["section"] == 0) & (symbols["name"] > 0)]
    return [strings[start : strings.index(b"\0", start)].decode() for start in starts.tolist()]
