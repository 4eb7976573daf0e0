"""What the documents show is what happens."""
from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["RABILINE_PROGRAM"]
ROWS = [line.strip("| \n").split(" | ") for line in (ROOT / "docs/mistakes.md").read_text().splitlines()[7:] if line.startswith("|")]


def test_every_link_of_the_documents_leads_to_a_file() -> None:
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]
    links = [(page, link) for page in pages for link in re.findall(r"\]\(([^)#:]+)\)", page.read_text())]
    assert len(links) > 30
    assert not [f"{page.name}: {link}" for page, link in links if not (page.parent / link).exists()]


def test_twenty_mistakes_are_listed() -> None:
    assert len(ROWS) >= 20 and all(len(row) == 4 for row in ROWS)


@pytest.mark.parametrize(("instead", "written", "said", "helped"), ROWS)
def test_a_mistake_is_told_as_its_page_says(tmp_path: Path, instead: str, written: str, said: str, helped: str) -> None:
    right = (ROOT / "beamline/ramsey.yaml").read_text()
    wrong, = (cell.strip("`").replace("⏎", "\n") for cell in [written])
    assert instead.strip("`") in right
    (tmp_path / "a.yaml").write_text(right.replace(instead.strip("`"), wrong, 1))
    told = json.loads(subprocess.run([PROGRAM, "check", "--json", tmp_path / "a.yaml"], capture_output=True, text=True).stdout)
    kind, message = said.split(": ", 1)
    assert any(each["message"].startswith(message) and each["help"] == helped for each in told[f"{kind}s"]), told


@pytest.mark.slow
def test_the_sextupole_source_is_improved_in_fifteen_lines() -> None:
    pytest.importorskip("rabiline._core", reason="built without pybind11")
    example = ROOT / "docs/example/optimise.py"
    assert sum(bool(line.strip()) and not line.startswith('"""') for line in example.read_text().splitlines()) <= 15
    told = subprocess.run([sys.executable, example, "60"], check=True, capture_output=True, text=True).stdout
    first, best = map(float, re.findall(r"0\.\d+", told)[:2])
    assert best > 1.5 * first
