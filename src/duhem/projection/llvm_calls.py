"""Functions in LLVM's text where numba calls them: it is handed their code, and works through nothing of it."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable, Mapping
from typing import Any

from duhem.projection.llvm_loops import lowered
from duhem.projection.llvm_values import NotLowered

__all__ = ["called"]


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
