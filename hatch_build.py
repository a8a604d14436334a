"""Compiles shared/actum/_compiled.c where a C compiler is at hand; without one the package works as well, slower."""

import hashlib
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SOURCE = "shared/actum/_compiled.c"
LIBRARY = "shared/actum/_compiled.abi3.so"
ROUNDING = ("-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")
"""As NumPy rounds: a product is rounded before it is added to; errno and traps, which nobody reads, cost vectors."""
LOADABLE = ("-bundle", "-undefined", "dynamic_lookup") if sys.platform == "darwin" else ("-shared", "-fPIC")
FIRST_PYTHON = "cp311"
"""The library uses the limited interface of this Python, and loads in all later ones."""


class CustomBuildHook(BuildHookInterface[Any]):
    """Adds the compiled library to wheels and editable installations."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile before the files are gathered."""
        if self.target_name != "wheel":
            return
        problem = compiled(Path(self.root) / SOURCE, Path(self.root) / LIBRARY)
        if problem is not None:
            self.app.display_warning(f"the compiled steps are left out, NumPy does the same more slowly: {problem}")
            return
        build_data["artifacts"].append(LIBRARY)
        if version != "editable":
            platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
            build_data |= {"pure_python": False, "tag": f"{FIRST_PYTHON}-abi3-{platform}"}


def compiled(source: Path, library: Path) -> str | None:
    """Compile a source to a library that Python can load; return why that cannot be, None where it was done."""
    library.unlink(missing_ok=True)
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        return "no C compiler found (cc, gcc or clang)"
    digest = hashlib.sha256(source.read_bytes()).hexdigest()  # `actum.core` compares it
    include = f"-I{sysconfig.get_paths()['include']}"
    done = subprocess.run(
        [
            compiler,
            "-O3",
            *ROUNDING,
            *LOADABLE,
            include,
            f'-DSOURCE="{digest}"',
            str(source),
            "-o",
            str(library),
            "-lm",
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    return None if done.returncode == 0 else f"{compiler} failed: {done.stderr.strip()[-500:]}"
