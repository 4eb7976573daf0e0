"""What reports, tables and fits tell: in the units of the user, whole, and soon."""
from __future__ import annotations

import cProfile
import csv
import json
import pstats
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from runs import LAWS, ROOT, folder, rabiline, run  # noqa: F401

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline as package  # noqa: E402
from rabiline import forms, lines, results  # noqa: E402
from rabiline.__main__ import main  # noqa: E402
from rabiline.curves import curves, deepest, half_maxima  # noqa: E402
from rabiline.forecasting import forecast  # noqa: E402
from rabiline.templates import _cut, templates  # noqa: E402

BEAMLINE, EXAMPLES = ROOT / "beamline", ROOT / "docs" / "example"
IN_KHZ = """a.frequency [kHz],counts
9192631.2,100
9192631.4,120
9192631.6,400
9192631.7,800
9192631.8,500
9192631.9,180
9192632.0,120
9192632.1,100
"""


@pytest.fixture(scope="module")
def licl(folder: Path) -> Path:
    return run(folder / "licl.h5", experiment=BEAMLINE / "rabi-licl.yaml")


@pytest.fixture(scope="module")
def of_laws(folder: Path) -> Path:
    return run(folder / "laws.h5", "--particles", 5000, *LAWS)


def calls_of(function: object, *arguments: object) -> tuple[object, int]:
    """What a function gives, and how many calls are inside."""
    profile = cProfile.Profile()
    found = profile.runcall(function, *arguments)
    return found, pstats.Stats(profile).total_calls


def test_findings_of_a_model_are_told_as_json(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    path = tmp_path / "model.h5"
    assert rabiline("run", BEAMLINE / "rotating-cylinder.yaml", "-o", path).returncode == 0
    assert main(["summary", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    found = {finding.name: finding for finding in package.open(path).findings}
    assert told["model"] == "rotating_cylinder" and told["scan"] == [] and len(told["findings"]) == len(found) > 10
    for finding in told["findings"]:
        assert finding["unit"] == found[finding["name"]].units and finding["value"] == found[finding["name"]].values.tolist()


def test_a_line_is_told_in_the_unit_of_its_scan(tmp_path: Path, licl: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "a.csv").write_text(IN_KHZ)
    assert main(["fit-line", str(tmp_path / "a.csv"), "--form", "lorentz"]) == 0
    told = capsys.readouterr().out
    assert "\ncentre     9192631.71" in told and "\nwidth      0.1" in told and told.count(" kHz\n") == 2
    assert main(["fit-line", str(licl), "--form", "rabi"]) == 0
    told = capsys.readouterr().out
    assert "\ncentre     212.59" in told and "\ntime       0.6" in told and " mT\n" in told and " 1/mT\n" in told


def test_a_fit_tells_values_and_profiles_in_the_units_of_the_file(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    text = (EXAMPLES / "ramsey-fringes.yaml").read_text().replace("field: 1 mT", "field: 1000 uT").replace("110 uT", "0.11 mT")
    (tmp_path / "a.yaml").write_text(text)
    flown = package.load(tmp_path / "a.yaml").set(particles=2000).run()
    rows = (f"{x / 1e3:.9f},{40000 * y:.0f}" for x, y in zip(flown.scan.axes[0].values, flown.detected))
    (tmp_path / "a.csv").write_text("\n".join(["C1.frequency [kHz],counts", *rows]))
    assert main(["fit", str(tmp_path / "a.yaml"), "--data", str(tmp_path / "a.csv"), "--particles", "2000",
                 "--free", "guide.field,C1.amplitude+C2.amplitude,scale"]) == 0
    told = {line.split()[0]: line for line in capsys.readouterr().out.splitlines()}
    assert told["guide.field"].count("µT") == 3 and told["C1.amplitude+C2.amplitude"].count(" mT") == 3


@pytest.mark.parametrize("change, unit", [({}, ("mT", 1e-3)), ({"B.field": "9500 uT"}, ("µT", 1e-6)), ({"B.field": "95 G"}, ("G", 1e-4))])
def test_a_number_has_the_unit_in_which_it_was_written_last(change: dict[str, str], unit: tuple[str, float] | None) -> None:
    changed = package.load(BEAMLINE / "suggested-experiment.yaml").set(change)
    assert changed.written_unit("B.field") == unit and changed.written_unit("H0.frequency") == ("kHz", 1e3)
    assert changed.written_unit("particles") is None and changed.written_unit("scale") is None


def test_tables_have_the_populations_of_levels(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    flown = package.load(BEAMLINE / "caesium-clock.yaml").set(particles=20).run()
    frame, levels = flown.to_dataframe(), flown.detectors["wire"].levels
    for column, values in (("wire: F=4 m=0", levels.fractions), ("wire: F=4 m=0_error", levels.errors)):
        np.testing.assert_array_equal(frame[column], values[:, levels.labels.index("F=4 m=0")])
    flown.to_csv(tmp_path / "a.csv")
    header = list(csv.reader((tmp_path / "a.csv").read_text().splitlines()))[2]
    assert header[0] == "first.frequency [Hz]" and [f"wire: {label}" for label in levels.labels] == header[3::2]
    data = pytest.importorskip("xarray") and flown.to_xarray()
    np.testing.assert_array_equal(data["levels_wire"].sel({"level_wire": "F=4 m=0"}), frame["wire: F=4 m=0"])


def test_levels_of_a_detector_stand_in_its_own_rows() -> None:
    pytest.importorskip("pandas")
    text = (BEAMLINE / "ramsey.yaml").read_text()
    other = "parts:\n  - {name: behind, kind: detector, at: 3 m, width: 10 cm, height: 10 cm, bins: [1, 1]}"
    frame = package.load(text.replace("parts:", other, 1)).scan().set(particles=20).run().to_dataframe()
    own = frame["detector"] == "behind"
    assert frame.filter(like="screen: ").shape == (2, 4)
    assert frame[~own].filter(like="screen: ").notna().all(axis=None) and frame[own].filter(like="screen: ").isna().all(axis=None)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.name)
def test_examples_of_the_documents_name_the_schema(path: Path) -> None:
    first = path.read_text().splitlines()[0]
    assert first.startswith("# yaml-language-server: $schema=") and (path.parent / first.partition("=")[2]).samefile(BEAMLINE / "rabiline.schema.json")


def halved(counts: np.ndarray, least: float) -> list[np.ndarray]:
    """The counts [laws, nx, nz] of each cell, one after the other."""
    for axis in sorted((1, 2), key=lambda axis: -counts.shape[axis]):
        below = counts.sum(axis=3 - axis).cumsum(axis=1)
        above = below[:, -1:] - below
        uneven = np.where((below.max(axis=0) >= least) & (above.max(axis=0) >= least), np.abs(below - above).sum(axis=0), np.inf)
        if np.isfinite(uneven).any():
            return [cell for half in reversed(np.split(counts, [int(np.argmin(uneven)) + 1], axis)) for cell in halved(half, least)]
    return [counts]


@pytest.mark.parametrize("shape", [(1, 1), (1, 90), (30, 40), (60, 7)])
def test_screens_are_cut_in_two_again_and_again(shape: tuple[int, int]) -> None:
    generator = np.random.default_rng(3)
    counts = generator.poisson(generator.gamma(0.3, 20, (3, 4, *shape))).astype(float)
    cells = _cut(counts, np.full(4, 50.0))
    expected = [cell.sum(axis=(1, 2)) for point in range(4) for cell in halved(counts[:, point], 50.0)]
    for law in range(3):
        np.testing.assert_array_equal(np.bincount(cells.ravel(), counts[law].ravel()), [cell[law] for cell in expected])


def test_screens_of_all_points_are_cut_in_few_calls(of_laws: Path) -> None:
    made, calls = calls_of(templates, results.read(of_laws), "law")
    assert made.screens[0].cells.shape[0] == 101 and calls < 10**5  # a million where each half is looked at by itself


def test_a_start_of_fringes_that_leads_nowhere_is_given_up(licl: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (curve,), called, two_fields = curves(results.read(licl)), [], forms._two_fields
    monkeypatch.setattr(forms, "_two_fields", lambda *values: called.append(1) or two_fields(*values))
    assert lines.fit_line(curve.x, curve.y, curve.covariance, "ramsey").chi_squared < 25000
    assert len(called) < 4000  # 8000 to its end


@pytest.mark.parametrize("command", ["compare-laws", "fit-line"])
def test_words_without_a_picture_load_nothing_that_takes_long(command: str, licl: Path, of_laws: Path) -> None:
    path = of_laws if command == "compare-laws" else licl
    code = f"import sys; from rabiline.__main__ import main; main([{command!r}, {str(path)!r}]); assert not {{'matplotlib', 'scipy.stats'}} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


def test_a_result_is_read_in_few_calls(licl: Path) -> None:
    assert calls_of(results.read, licl)[1] < 15000


def test_a_fringe_is_as_wide_with_few_particles_as_with_many() -> None:
    """Points of a scan share their particles: what tells fringes from a line is how they differ, and not their own errors."""
    clock = package.load(ROOT / "beamline/caesium-clock.yaml")
    few, many = (deepest(half_maxima(curves(clock.set(particles=particles).run())[0])) for particles in (1000, 20000))
    assert abs(few.width.value - many.width.value) < 3 * np.hypot(few.width.error, many.width.error) < 15


def test_parameters_that_are_scanned_together_are_one_column(tmp_path: Path) -> None:
    text = (EXAMPLES / "ramsey-fringes.yaml").read_text().replace("oscillator: C1, approximation: rotating_wave, phase: locked", "frequency: 29.1647 kHz, approximation: rotating_wave, phase: locked")
    text = text.replace("parameter: C1.frequency", "parameter: [C1.frequency, C2.frequency]")
    path = tmp_path / "two.yaml"
    path.write_text(text)
    experiment = package.load(path).set(particles=4000)
    told = forecast(experiment, ["guide.field"], rate=1000)
    assert told.counts == pytest.approx(1000 * np.ravel(experiment.fly().detected), rel=1e-6)
    x = np.linspace(28664.7, 29664.7, 41)
    for header in ('"C1.frequency,C2.frequency [Hz]"', "C1.frequency+C2.frequency [Hz]"):
        (tmp_path / "a.csv").write_text("\n".join([f"{header},counts", *(f"{at:.1f},{round(count)}" for at, count in zip(x, told.counts))]))
        fit = experiment.fit(tmp_path / "a.csv", ["guide.field"])
        assert abs(fit["guide.field"][0] - 1e-3) < 0.5 * fit["guide.field"][1] and fit.counts.parameter == "C1.frequency,C2.frequency"
