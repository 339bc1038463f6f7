"""Text that numba compiles: once a text, then kept on disk, so that the next process loads it.

The machine code that numba has made is run without importing numba.  Importing numba and having it load a function that it kept
takes longer than all else that a first increment does.  What it kept is an object file, which llvmlite alone can load; what that
calls is Python's, the C library's or that of numba's extension modules, which are loaded by themselves.  So the same machine code
runs, to the bit.

What is kept is found by the text, the kinds of the arguments and everything that the code was made with and for, and is sealed.  Where
anything is missing or other than expected there is none, and numba finds its own or compiles.
"""

from __future__ import annotations

import ast
import builtins
import ctypes
import hashlib
import inspect
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import cache, cached_property, lru_cache
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.errors import MissingExtraError
from duhem.expression.syntax import module_tree
from duhem.projection import file_cache, llvm_loops, llvm_values
from duhem.projection.llvm_loops import lowered
from duhem.projection.llvm_values import NotLowered

__all__ = ["WITHIN", "CompiledText", "compiled_text", "interpreted_text", "only_read"]

WITHIN = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""What numba is told of functions that compiled code alone calls."""

_MEANT = {"solve": "closest point", "judge": "check of answers"}


@lru_cache(maxsize=128)
def compiled_text(text: str, entry: str) -> CompiledText:
    """The function ``entry`` of a module of our own text, compiled with the functions it calls; it lets go of the interpreter.

    What is not yet on disk is compiled at the first call (some seconds).  MissingExtraError without numba.
    """
    if find_spec("numba") is None:
        raise MissingExtraError("numba", "fast")
    return CompiledText(f"{text}\n# lowered by {_lowered_by()}\n", entry)


@cache
def _lowered_by() -> str:
    """Stands for our own part of the compiler: where it is another, what was kept is of no use."""
    return _name("".join(map(inspect.getsource, (sys.modules[__name__], llvm_loops, llvm_values))))


def only_read(given: NDArray[Any]) -> NDArray[Any]:
    """The array whole, and not to be written to, as compiled text takes what it reads: each kind of array is compiled for by itself."""
    whole = np.ascontiguousarray(given).view()
    whole.setflags(write=False)
    return whole


class CompiledText:
    """A function that runs as machine code from disk where there is some for its arguments, and else through numba."""

    def __init__(self, text: str, name: str) -> None:
        self._text, self._name, self._lowered = text, name, True
        self._kept = _kept(text)
        self._runs: dict[Kinds, Callable[..., Any]] = {}
        self._lock = Lock()

    def __call__(self, *arguments: Any) -> Any:
        try:
            known = kinds(arguments)
        except LookupError:
            return self._through_numba(arguments)
        if (run := self._runs.get(known)) is None:
            with self._lock:
                run = self._runs.get(known) or self._found(known)
            if run is None:
                return self._first(known, arguments)
        return run(*arguments)

    def specialised(self, *arguments: Any) -> Callable[..., Any]:
        """The machine code for arguments of the kinds of these, which it is called with once: nothing is looked up again."""
        self(*arguments)
        return self._runs.get(kinds(arguments), self)

    def _found(self, known: Kinds) -> Callable[..., Any] | None:
        path = None if self._kept is None else place(self._kept, self._name, known)
        run = None if path is None else kept(path, self._name)
        if run is not None:
            self._runs[known] = run
        return run

    def _first(self, known: Kinds, arguments: tuple[Any, ...]) -> Any:
        """Compiled by numba, or found where that keeps it, and kept for the next process."""
        import logging  # which numba has loaded

        logging.getLogger("duhem").warning(
            "waiting for numba: to compile the %s of a law takes 2 to 15 seconds, once", _MEANT.get(self._name, "loop")
        )
        result = self._through_numba(arguments)
        self._runs[known] = compiled = self._by_numba
        if self._kept is not None and (path := place(self._kept, self._name, known)) is not None:
            keep(path, compiled, arguments)
        return result

    def _through_numba(self, arguments: tuple[Any, ...]) -> Any:
        """By numba with LLVM's text of what the function calls, or, where that cannot be, by numba alone: slower, never other."""
        with self._lock:
            compiled = self._by_numba
        try:
            return compiled(*arguments)
        except (NotLowered, _numba().core.errors.NumbaError, *_OTHER):
            if not self._lowered:
                raise
        with self._lock:
            self._lowered = False
            self.__dict__.pop("_by_numba", None)
        return self._through_numba(arguments)

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        """The function as written: inspect reads its arguments."""
        written: Callable[..., Any] = self._by_numba.py_func
        return written

    @cached_property
    def _by_numba(self) -> Any:
        numba = _numba()
        kept, text = self._kept, self._text
        module = ModuleType(f"duhem_{kept.stem}" if kept else f"duhem_generated_{_name(text)}")
        sys.modules[module.__name__] = module  # where what was kept looks for it
        space = module.__dict__
        exec(
            compile(text, str(kept or "<generated>"), "exec"), space
        )  # our own text: of the user's formula it has SymPy's numbers and our names
        written, several = dict(space), _returning_several(text)
        for name, value in written.items():
            if inspect.isfunction(value) and value.__module__ == module.__name__ and name != self._name:
                space[name] = called(text, written, name) if self._lowered and name not in several else numba.njit(**WITHIN)(value)
        return numba.njit(error_model="numpy", cache=kept is not None, nogil=True)(space[self._name])


def _returning_several(text: str) -> set[str]:
    """The functions of a text that return a tuple."""
    functions = [node for node in module_tree(text).body if isinstance(node, ast.FunctionDef)]
    ends = [(node.name, part.value) for node in functions for part in ast.walk(node) if isinstance(part, ast.Return)]
    return {name for name, value in ends if isinstance(value, ast.Tuple)}


def interpreted_text(text: str | ast.Module, entry: str) -> Callable[..., None]:
    """The function ``entry`` of our own text, parsed or not, as Python runs it: for what is called too seldom to be worth compiling."""
    space: dict[str, Any] = {}
    exec(compile(text, "<generated>", "exec"), space)
    run: Callable[..., None] = space[entry]
    return run


def _numba() -> Any:
    """numba, not asking SciPy whether there is a BLAS: that loads all of scipy.linalg, a tenth of what a first increment takes.

    It asks when its module on arrays is imported, and again where a function that it compiles has need of one: there it finds out.
    """
    try:
        import numba
    except ImportError:
        raise MissingExtraError("numba", "fast") from None
    on_arrays = "numba.np.arraymath"
    if on_arrays not in sys.modules and "scipy.linalg" not in sys.modules and find_spec("scipy") is not None:
        with suppress(ImportError, AttributeError):  # another version of numba
            linalg: Any = import_module("numba.np.linalg")
            asks = linalg.ensure_blas
            linalg.ensure_blas = lambda: None
            try:
                import_module(on_arrays).ensure_blas = asks  # type: ignore[attr-defined]
            finally:
                linalg.ensure_blas = asks
    return numba


def _name(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _kept(text: str) -> Path | None:
    """The file with this text, beside which numba keeps what it compiles; None where there is no place for it."""
    folder = kept_folder()
    path = folder / f"law_{_name(text)}.py"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not path.is_file() or path.read_text("utf-8") != text:
            beside = path.with_suffix(f".{os.getpid()}")
            beside.write_text(text, "utf-8")
            beside.replace(path)
        return path
    except OSError:
        return None


def kept_folder() -> Path:
    """Where is kept what the next process need not make again: DUHEM_CACHE_DIR, else the user's folder for such things."""
    if own := os.environ.get("DUHEM_CACHE_DIR"):
        return Path(own)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "duhem"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "duhem"


# -- machine code, run without importing numba -------------------------------------------------------------------------


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


# -- functions in LLVM's text where numba calls them: it is handed their code and does not compile it -----------------


def called(text: str, space: Mapping[str, Any], name: str) -> Callable[..., Any]:
    """The function ``name`` of the text, whose module has the names ``space``, as compiled functions may call it.

    It returns a number or nothing; NotLowered, where it is compiled, for what has no place in LLVM's text here.
    """
    import llvmlite.binding as llvm
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.extending import intrinsic

    elements = {types.float64: "double", types.int64: "i64", types.int8: "i8"}
    numbers = {types.float64: "double", types.int64: "i64", types.boolean: "i1"}
    returns = {
        "double": (types.float64, ir.DoubleType()),
        "i64": (types.int64, ir.IntType(64)),
        "i1": (types.boolean, ir.IntType(1)),
        "void": (types.none, ir.VoidType()),
    }

    def kinds(given: Any) -> Any:
        if isinstance(given, types.BaseTuple):
            return ("tuple", *map(kinds, given))
        if isinstance(given, types.Array) and given.dtype in elements and given.layout in "CF":
            return elements[given.dtype], given.ndim, given.layout
        if given in numbers:
            return numbers[given]
        raise NotLowered(str(given))

    def carried(context: Any, builder: Any, kind: Any, value: Any) -> list[Any]:
        if isinstance(kind, types.BaseTuple):
            parts = zip(kind, cgutils.unpack_tuple(builder, value, len(kind)), strict=True)
            return [each for part in parts for each in carried(context, builder, *part)]
        if isinstance(kind, types.Array):
            array = context.make_array(kind)(context, builder, value)
            return [array.data, *cgutils.unpack_tuple(builder, array.shape)]
        return [value]

    def typed(_: Any, *arguments: Any) -> Any:
        given = tuple(map(types.unliteral, arguments))
        asked = tuple(map(kinds, given))
        own = f"{name}.{hashlib.sha256(repr((text, asked)).encode()).hexdigest()[:32]}"
        code, returned = lowered(text, space, name, asked, own)
        module = llvm.parse_assembly(f'target triple = "{llvm.get_process_triple()}"\n{code}')
        module.verify()
        result, kind = returns[returned]

        def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            library = context.active_code_library
            library._optimize_functions(module)
            library.add_linking_library(_Ready(module))
            handed = [each for part in zip(signature.args, values, strict=True) for each in carried(context, builder, *part)]
            function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [each.type for each in handed]), own)
            made = builder.call(function, handed)
            return context.get_dummy_value() if returned == "void" else made

        return result(*given), call

    names = inspect.signature(space[name]).parameters.values()
    typed.__signature__ = inspect.Signature([inspect.Parameter("_", inspect.Parameter.POSITIONAL_OR_KEYWORD), *names])  # type: ignore[attr-defined]
    made: Callable[..., Any] = intrinsic(typed)
    return made


class _Ready:
    """A module that numba links as it is: it is optimized once, with all that calls it, and not by itself."""

    def __init__(self, module: Any) -> None:
        self._module, self._reload_init = module, set[Any]()

    def _ensure_finalized(self) -> None: ...

    def _get_module_for_linking(self) -> Any:
        return self._module
