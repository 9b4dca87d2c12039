"""Machine code that numba keeps on disk, loaded without the intermediate code beside it.

numba parses that for each function at once: of the companion 44 MB and 0.2 s, for what no flight needs. Here it waits
until a function is compiled that calls the loaded one. numba has no other way in than its own private names, so only
the version with which this was tried gets it (`link.compiled`).
"""

from typing import Any

from llvmlite import binding as llvm
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen


class _KeptCode(JITCodeLibrary):  # type: ignore[misc]  # numba has few annotations
    _shared_module: llvm.ModuleRef | None
    _intermediate: bytes = b""

    @classmethod
    def _unserialize(cls, codegen: JITCPUCodegen, state: tuple[str, str, Any]) -> Any:
        name, kind, data = state
        if kind != "object":
            return super()._unserialize(codegen, state)
        library: Any = codegen.create_library(name)
        machine_code, library._intermediate = data
        library.enable_object_caching()
        library._set_compiled_object(machine_code)
        library._finalize_final_module()
        return library

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of a function of this library."""
        if not self._intermediate:
            return int(super().get_pointer_to_function(name))
        return int(self.codegen._engine.get_function_address(name))  # numba would look only into what was parsed

    def _get_module_for_linking(self) -> llvm.ModuleRef:
        if self._intermediate and self._shared_module is None:
            self._shared_module = llvm.parse_bitcode(self._intermediate)
        return super()._get_module_for_linking()


def load_without_intermediate_code() -> None:
    """Let numba load what it keeps as described above, from now on."""
    JITCPUCodegen._library_class = _KeptCode
