"""What is installed on a drone: no tool of the tests, and nothing whose licence asks for more than its own source."""

import re
from itertools import pairwise

from scenarios.manual.licences import licence_of, licences_page, packages

TEST_TOOLS = {"mavproxy", "mavsdk", "pytest", "hypothesis", "mypy", "ruff", "playwright", "mkdocs-material"}


def test_page_of_licences_names_each_package_once() -> None:
    rows = re.findall(r"^\| .* \| (.*) \|$", licences_page(), re.MULTILINE)[2:]
    assert sorted(name for row in rows for name in row.split(", ")) == packages()


def test_drones_lock_has_no_tool_of_the_tests() -> None:
    names = packages()
    assert "pymavlink" in names
    assert all(before < after for before, after in pairwise(names))
    assert TEST_TOOLS.isdisjoint(names)


def test_packages_on_a_drone_say_their_licence_and_none_is_under_the_gpl() -> None:
    licences = {package: licence_of(package) for package in packages()}
    assert [package for package, said in licences.items() if said == "not said"] == []
    gpl = re.compile(r"(?<!L)(?<!Lesser )(GPL|General Public)")
    assert [package for package, said in licences.items() if gpl.search(said)] == []
