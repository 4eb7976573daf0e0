"""Every public name of the package says what it is, and every array what its shape is."""
from __future__ import annotations

import ast
from pathlib import Path
from typing import Iterator

import pytest
import rabiline

MODULES = sorted(Path(rabiline.__file__).parent.glob("*.py"))
USERS = {"Experiment", "Results", "Flown", "Tracks", "Motions", "CountsFit", "LineFit"}  # what a user of the package holds
FOR_USERS = {"experiment", "files", "fitting", "forecasting", "lines", "counts", "results", "tracks", "motions"}  # modules
CAN_FAIL = {"load", "open", "read", "set", "scan", "run", "trace", "fit", "plot", "to_csv", "write", "value", "unit", "fit_counts",
            "forecast", "fit_line", "read_counts"}


def public(tree: ast.AST, owner: str = "") -> Iterator[tuple[str, str, ast.AST]]:
    """(class, name, definition) of a module's classes, functions and methods."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and not node.name.startswith("_"):
            yield owner, node.name, node
            if isinstance(node, ast.ClassDef):
                yield from public(node, node.name)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_every_public_name_says_what_it_is(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    overrides = {("Parser", "error")}
    lacking = [name for owner, name, node in public(tree) if not ast.get_docstring(node) and (owner, name) not in overrides]
    assert ast.get_docstring(tree) and not lacking


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_what_gives_an_array_tells_its_shape(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    silent = [name for _, name, node in public(tree) if isinstance(node, ast.FunctionDef) and node.returns is not None
              and ast.unparse(node.returns) == "np.ndarray" and "[" not in (ast.get_docstring(node) or "")]
    assert not silent


def test_what_a_user_calls_tells_the_errors_that_it_raises() -> None:
    silent = [f"{path.stem}.{owner}.{name}" for path in MODULES for owner, name, node in public(ast.parse(path.read_text(encoding="utf-8")))
              if isinstance(node, ast.FunctionDef) and name in CAN_FAIL and (owner in USERS or not owner and path.stem in FOR_USERS)
              and "aises" not in (ast.get_docstring(node) or "")]
    assert not silent


def test_arrays_in_what_a_user_holds_have_their_shape_beside_them() -> None:
    silent = []
    for path in MODULES:
        lines = path.read_text(encoding="utf-8").splitlines()
        for _, owner, node in public(ast.parse("\n".join(lines))):
            silent += [f"{path.stem}.{owner}.{field.target.id}" for field in getattr(node, "body", []) if isinstance(node, ast.ClassDef)
                       and owner in USERS and isinstance(field, ast.AnnAssign) and ast.unparse(field.annotation).startswith("np.ndarray")
                       and "[" not in lines[field.lineno - 1].partition("#")[2]]
    assert not silent
