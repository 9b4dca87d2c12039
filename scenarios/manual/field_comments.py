"""The comments beside the values of a class, which are where a number's meaning and source stand."""

import ast
import inspect
import io
import sys
import tokenize
from collections.abc import Mapping
from functools import cache
from types import ModuleType


def comments_of(owner: type) -> Mapping[str, str]:
    """Return the comment of each name that is assigned in the body of a class, those of its bases included.

    It is what stands beside the assignment; else what stands in lines of its own above it.
    """
    found: dict[str, str] = {}
    for one in reversed(owner.__mro__):
        module = sys.modules.get(one.__module__)
        if module is not None and one.__module__.split(".")[0] in {"companion", "link", "scenarios", "sim_autopilot"}:
            found |= _of_module(module).get(one.__name__, {})
    return found


@cache
def _of_module(module: ModuleType) -> Mapping[str, Mapping[str, str]]:
    source = inspect.getsource(module)
    comments = _comments(source)
    classes = (node for node in ast.parse(source).body if isinstance(node, ast.ClassDef))
    return {node.name: _of_class(node, comments) for node in classes}


def _of_class(node: ast.ClassDef, comments: Mapping[int, tuple[str, bool]]) -> dict[str, str]:
    found: dict[str, str] = {}
    for statement in node.body:
        if not isinstance(statement, ast.Assign | ast.AnnAssign):
            continue
        target = statement.targets[0] if isinstance(statement, ast.Assign) else statement.target
        if isinstance(target, ast.Name):
            found[target.id] = _beside(statement, comments) or _above(statement, comments)
    return found


def _beside(statement: ast.stmt, comments: Mapping[int, tuple[str, bool]]) -> str:
    lines = range(statement.lineno, (statement.end_lineno or statement.lineno) + 1)
    return " ".join(comments[line][0] for line in lines if line in comments)


def _above(statement: ast.stmt, comments: Mapping[int, tuple[str, bool]]) -> str:
    texts: list[str] = []
    line = statement.lineno - 1
    while line in comments and comments[line][1]:
        texts.insert(0, comments[line][0])
        line -= 1
    return " ".join(texts)


def _comments(source: str) -> dict[int, tuple[str, bool]]:
    """Return each line's comment, and whether it has the line to itself."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return {
        token.start[0]: (token.string.removeprefix("#").strip(), token.line.lstrip().startswith("#"))
        for token in tokens
        if token.type == tokenize.COMMENT
    }
