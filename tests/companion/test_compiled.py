"""Machine code is kept by all files that hold compiled functions."""

from pathlib import Path
from types import ModuleType

import pytest

from companion.forecast import compiled as forecast
from companion.planning import compiled as planning
from companion.vehicle import compiled as estimation


@pytest.mark.parametrize("package", [estimation, planning, forecast])
def test_every_file_with_kept_functions_is_in_the_digest(package: ModuleType) -> None:
    assert package.__file__ is not None
    folder = Path(package.__file__).parent
    users = [
        path.name
        for path in folder.glob("*.py")
        if f"from {package.__name__} import compiled_kernel" in path.read_text()
    ]
    assert sorted(package.FILES) == sorted(users)
    assert not [path.name for path in folder.glob("*.py") if "njit" in path.read_text()]
