"""Fields that differ from place to place: `probe`, maps of both formats, and files that lie about themselves."""
import csv
import io
import random
import re
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from experiments import RABILINE as PROGRAM

EXPERIMENT = """rabiline: 1
species: neutron
law: quantum
source:
  speed: {{kind: single, value: 1000 m/s}}
  opening: {{width: 0.2 mm, height: 0.2 mm}}
  direction: parallel
parts:
  - {{name: F, at: 1 m, {part}}}
  - {{name: D, kind: detector, at: 2 m, width: 1 cm, height: 1 cm, bins: [10, 10]}}
particles: 100
seed: 1
"""
LOOP = "kind: current_loop, radius: 5 cm, field: 1 mT"
X = np.arange(-4, 5) * 1e-3
Y = np.arange(-10, 11) * 1e-3


def experiment(folder: Path, part: str, name: str = "field.yaml") -> Path:
    path = folder / name
    path.write_text(EXPERIMENT.format(part=part))
    return path


def run(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


def line(path: Path, at: str, along: str, begin: str, end: str, points: int) -> np.ndarray:
    out = run("probe", path, "--at", at, "--along", along, "--from", begin, "--to", end, "--points", points)
    assert out.returncode == 0, out.stderr
    return np.array([[float(cell) for cell in row] for row in list(csv.reader(io.StringIO(out.stdout)))[1:]])


def loop_on_grid(tmp_path: Path) -> np.ndarray:
    """B of the loop over (x, y, z), from `probe`."""
    path = experiment(tmp_path, LOOP, "loop.yaml")
    field = np.zeros((len(X), len(Y), len(X), 3))
    for i, x in enumerate(X):
        for k, z in enumerate(X):
            field[i, :, k] = line(path, f"{x} m,0 m,{z} m", "y", "0.99 m", "1.01 m", len(Y))[:, 3:6]
    return field


def write_csv(path: Path, field: np.ndarray) -> None:
    rows = [f"{1e6 * field[i, j, k, 2]:.12g}, {1e3 * z:.6g}, {1e2 * y:.6g}, {1e3 * field[i, j, k, 0]:.12g}, {1e3 * x:.6g}, "
            f"{field[i, j, k, 1] * 1e4:.12g}"
            for i, x in enumerate(X) for j, y in enumerate(Y) for k, z in enumerate(X)]
    random.Random(1).shuffle(rows)
    path.write_text("# a loop\nBz [uT], z [mm], y [cm], Bx [mT], x [mm], By [G]\n" + "\n".join(rows) + "\n")


def write_hdf5(path: Path, field: np.ndarray) -> None:
    with h5py.File(path, "w") as file:
        for name, places in zip("xyz", (X, Y, X)):
            file.create_dataset(name, data=places * 1e3).attrs["units"] = "mm"
        for m, name in enumerate(("Bx", "By", "Bz")):
            file.create_dataset(name, data=field[..., m] * 1e3, compression="gzip").attrs["units"] = np.bytes_("mT")


@pytest.fixture(scope="module")
def maps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("maps")
    field = loop_on_grid(folder)
    write_csv(folder / "loop.csv", field)
    write_hdf5(folder / "loop.h5", field)
    return folder


def test_a_map_in_either_format_is_the_field_that_it_was_made_of(maps: Path) -> None:
    exact = line(experiment(maps, LOOP), "0.7 mm,0 m,-1.3 mm", "y", "0.991 m", "1.0087 m", 57)
    for name in ("loop.csv", "loop.h5"):
        mapped = line(experiment(maps, f"kind: field_map, map: {name}", name + ".yaml"), "0.7 mm,0 m,-1.3 mm", "y", "0.991 m",
                      "1.0087 m", 57)
        assert np.abs(mapped[:, 3:6] - exact[:, 3:6]).max() < 1e-9  # of 1e-3 T: steps of h/R = 1/50
        assert np.abs(mapped[:, 7:9]).max() < 2e-6  # T/m


def test_check_says_what_a_map_is_worth(maps: Path) -> None:
    out = run("check", experiment(maps, "kind: field_map, map: loop.csv", "check.yaml"))
    assert "9 x 21 x 9 nodes" in out.stdout
    assert "ends abruptly, at" in out.stdout
    turned = run("check", experiment(maps, "kind: field_map, map: loop.csv, tilt: {x: 45 deg}", "turned.yaml")).stdout
    assert "ends abruptly, at" in turned  # although its corners, beside the axis, reach further


def test_probe_names_the_parts_and_their_shares(tmp_path: Path) -> None:
    path = experiment(tmp_path, LOOP + "}\n  - {name: B, kind: uniform_field, at: 0.5 m, length: 1 m, field: 2 mT")
    out = run("probe", path, "--at", "0 m,1 m,0 m")
    assert "|B| = 2.236 mT" in out.stdout
    assert [row.split()[0] for row in out.stdout.splitlines()[2:4]] == ["B", "F"]  # along the beam
    assert run("probe", path, "--at", "0,1.6 m,0").stdout.splitlines()[2].split()[0] == "F"


def test_probe_warns_where_a_fringe_does_not_tell_what_the_field_is(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: uniform_field, length: 0.2 m, field: 1 mT, fringe: {kind: tanh, length: 10 mm}")
    assert run("probe", path, "--at", "0 m,1.0 m,1 mm").stderr == ""
    for place in (("--at", "0 m,1.0 m,200 mm"), ("--at", "0 m,1.0 m,0 m", "--along", "z", "--from", "0 m", "--to", "0.2 m")):
        told = run("probe", path, *place).stderr
        assert told.startswith("warning: ") and told.count("warning") == 1 and "from the axis of `F`" in told


def test_probe_takes_a_clock_at_its_time(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: rotating_field, length: 0.2 m, amplitude: 1 uT, frequency: 1 kHz, sense: positive, phase: locked")
    assert "B = (1 uT, 0 T, 0 T)" in run("probe", path, "--at", "0 m,1.1 m,0 m").stdout
    later = run("probe", path, "--at", "0 m,1.1 m,0 m", "--time", "0.25 ms").stdout
    assert "1 uT, 0 T), |B| = 1 uT" in later
    late = run("probe", path, "--at", "0 m,1.1 m,0 m", "--time", "1e12 s")
    assert late.returncode == 2 and late.stderr == "error: at 1e+12 s a drive has turned by more than 1e+08 radians: its phase is no longer known\n"


def test_a_solenoid_of_one_turn_is_told_of(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: solenoid, winding: 20 cm, radius: 2 cm, current: 1 A")
    assert "the solenoid `F` has one turn on a winding of 200 mm" in run("check", path).stdout
    path.write_text(path.read_text().replace("current: 1 A", "current: 1 A, turns: 400"))
    assert "one turn" not in run("check", path).stdout


def test_probe_shows_the_field_of_a_coil_as_the_first_species_has_it(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: coil, length: 5 cm, axis: x, angle: 90 deg, speed: 800 m/s")
    out = run("probe", path, "--at", "0,1.02 m,0").stdout
    assert "t = 0 s" in out and "F                (137.2 uT, 0 T, 0 T)" in out  # 90 deg = 2 pi 29.165 MHz/T B 62.5 us


@pytest.mark.parametrize("argument", ["1 m", "1 m,2 m", "1 m,2 s,0 m", "1 m,2 m,3 m,4 m"])
def test_probe_refuses_what_is_no_place(tmp_path: Path, argument: str) -> None:
    out = run("probe", experiment(tmp_path, LOOP), "--at", argument)
    assert out.returncode == 2
    assert "--at" in out.stderr and "help:" in out.stderr


def spoil_link(file: h5py.File) -> None:
    del file["Bx"]
    file["Bx"] = h5py.ExternalLink("loop.h5", "/By")


def spoil_virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=file["Bx"].shape, dtype="f8")
    layout[...] = h5py.VirtualSource("loop.h5", "By", shape=file["Bx"].shape)
    del file["Bx"]
    file.create_virtual_dataset("Bx", layout)
    file["Bx"].attrs["units"] = "mT"


def spoil_size(file: h5py.File, nodes: int = 400) -> None:
    for name in ("x", "y", "z"):
        del file[name]
        file.create_dataset(name, data=np.arange(float(nodes))).attrs["units"] = "mm"
    del file["Bx"]
    file.create_dataset("Bx", shape=(nodes, nodes, nodes), dtype="f8", chunks=(10, 10, 10)).attrs["units"] = "mT"


def spoil_limit(file: h5py.File) -> None:
    spoil_size(file, 1000)


def spoil_axis(file: h5py.File) -> None:
    file["y"][3] = file["y"][5]


def spoil_unit(file: h5py.File) -> None:
    file["By"].attrs["units"] = "mm"


def spoil_number(file: h5py.File) -> None:
    file["Bz"][1, 2, 3] = np.nan


def spoil_largest(file: h5py.File) -> None:
    file["Bz"][1, 2, 3] = 1.7e308


def spoil_steps(file: h5py.File) -> None:
    file["x"][...] = np.linspace(-1e200, 1e200, file["x"].size)


def spoil_shape(file: h5py.File) -> None:
    data = file["Bz"][:-1]
    del file["Bz"]
    file.create_dataset("Bz", data=data).attrs["units"] = "mT"


def spoil_type(file: h5py.File) -> None:
    data = file["Bz"][:].astype("i4")
    del file["Bz"]
    file.create_dataset("Bz", data=data).attrs["units"] = "mT"


@pytest.mark.parametrize("spoil, said", [
    (spoil_link, "/Bx: refused (it is a link to somewhere else)"), (spoil_virtual, "/Bx: refused (it is a virtual dataset)"),
    (spoil_size, "/Bx: refused (it claims more than it stores)"), (spoil_limit, "the map has 1e+09 nodes, which need 59.6 GiB"), (spoil_axis, "the places along y do not ascend"),
    (spoil_unit, "`mm` is not a unit of a magnetic field"), (spoil_number, "/Bz[1, 2, 3] is not finite"), (spoil_largest, "/Bz[1, 2, 3] is beyond 1e+300 in SI"), (spoil_steps, "the places along x stand"),
    (spoil_shape, "/Bz: refused (it has 8 numbers where its axis has 9)"), (spoil_type, "/Bz: refused (it does not hold real numbers)"),
    (lambda file: file.pop("Bz"), "there is no dataset /Bz"), (lambda file: file["x"].attrs.pop("units"), "/x, attribute units")])
def test_a_map_that_lies_is_refused_before_it_is_read(maps: Path, tmp_path: Path, spoil, said: str) -> None:
    (tmp_path / "loop.h5").write_bytes((maps / "loop.h5").read_bytes())
    bad = tmp_path / "bad.h5"
    bad.write_bytes((maps / "loop.h5").read_bytes())
    with h5py.File(bad, "r+") as file:
        spoil(file)
    out = run("check", experiment(tmp_path, "kind: field_map, map: bad.h5"))
    assert out.returncode == 2
    assert said in out.stderr, out.stderr
    assert "field.yaml:9" in out.stderr


def test_a_text_that_is_too_large_is_refused_by_its_size(tmp_path: Path) -> None:
    with (tmp_path / "big.csv").open("wb") as file:
        file.truncate(10 << 30)  # holes only
    out = run("check", experiment(tmp_path, "kind: field_map, map: big.csv"))
    assert out.returncode == 2
    assert "the file has 10.0 GiB; maps are read as text up to 2 GiB" in out.stderr


def test_the_results_of_a_map_know_which_map_it_was(maps: Path) -> None:
    path, output = experiment(maps, "kind: field_map, map: loop.csv", "run.yaml"), maps / "run.h5"
    out = run("run", path, "-o", output, "--progress", "none")
    assert out.returncode == 0, out.stderr
    with h5py.File(output) as file:
        texts = []
        file.visititems(lambda _, node: texts.append(node[()]) if isinstance(node, h5py.Dataset) and node.dtype.kind in "SO" else None)
    assert any(b"a field map of" in str(text).encode() for text in texts)


def flights_agree(first: int, count: int) -> int:
    """How many of the random set-ups flew and agreed; none may disagree."""
    script = Path(__file__).resolve().parents[2] / "tools" / "random-fields"
    told = subprocess.run([script, PROGRAM, "--first", str(first), "--count", str(count)], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout + told.stderr
    return int(told.stdout.split()[0])


def test_random_flights_through_random_fields_agree_with_an_independent_integration():
    assert flights_agree(0, 50) > 35


def test_a_path_that_a_field_bends_over_its_side_face_ends_a_step_there():
    assert flights_agree(6142, 1) == 1  # a neutron with a dipole goes over the faces of a tilted formula: 9e-6 where steps go over them


def test_random_atoms_through_random_fields_agree_with_their_whole_hamiltonian():
    script = Path(__file__).resolve().parents[2] / "tools" / "random-levels"
    told = subprocess.run([script, PROGRAM, "--count", "7"], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout + told.stderr
    assert int(told.stdout.split()[0]) > 5


BOX = "width: 1 cm, height: 1 cm, length: 20 cm, step: 2.5 mm"


def test_a_formula_is_the_field_that_it_states(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: formula_field, formula: {Bx: -G*x, By: 'B0*sin(2*pi*y/L)', Bz: B0 + G*z, "
                      "constants: {B0: 1 mT, G: 0.5 T/m, L: 20 cm}, " + BOX + "}")
    table = line(path, "0.7 mm,0 m,-1.3 mm", "y", "1.001 m", "1.199 m", 57)
    y = table[:, 1]
    expected = np.stack([np.full_like(y, -0.5 * 0.7e-3), 1e-3 * np.sin(10 * np.pi * (y - 1)), np.full_like(y, 1e-3 - 0.5 * 1.3e-3)], axis=1)
    assert np.abs(table[:, 3:6] - expected).max() < 1e-8
    check = run("check", path)
    assert "formula: 5 x 81 x 5 nodes" in check.stdout
    assert "the formula of `F` is no field without currents" in check.stdout + check.stderr  # By has a divergence


def levels_of(path: Path) -> np.ndarray:
    out = run("run", path, "-o", path.with_suffix(".h5"), "--progress", "none")
    assert out.returncode == 0, out.stderr
    with h5py.File(path.with_suffix(".h5")) as file:
        return file["entry/D_levels/levels"][:].ravel()


def test_a_linear_formula_flies_as_the_gradient_that_it_states(tmp_path: Path) -> None:
    levels = []
    for name, part in (("formula", "kind: formula_field, formula: {Bx: -G*x, Bz: B0 + G*z, constants: {B0: 1 mT, G: 1 mT/m}, " + BOX + "}"),
                       ("gradient", "kind: uniform_field, length: 20 cm, field: 1 mT, gradient: {quadrupole: 1 mT/m}")):
        path = experiment(tmp_path, part + "}\n  - {name: H0, kind: rotating_field, at: 1.05 m, length: 10 cm, amplitude: 80 uT, "
                          "frequency: 29.2 kHz, sense: co, phase: locked", f"{name}.yaml")
        levels.append(levels_of(path))
    assert 0.05 < levels[0][0] < 0.95
    assert np.abs(levels[0] - levels[1]).max() < 1e-6


def test_a_swinging_formula_drives_as_the_oscillating_field_of_its_size(tmp_path: Path) -> None:
    levels = []
    for name, part in (("formula", "kind: formula_field, formula: {Bx: '40e-6', " + BOX + "}, oscillates: {frequency: 29 kHz, phase: 30 deg}"),
                       ("drive", "kind: oscillating_field, length: 20 cm, amplitude: 40 uT, frequency: 29 kHz, phase: 30 deg, approximation: none")):
        path = experiment(tmp_path, part + "}\n  - {name: B, kind: uniform_field, at: 1 m, length: 20 cm, field: 1 mT", f"{name}.yaml")
        levels.append(levels_of(path))
    assert 0.05 < levels[0][0] < 0.95
    assert np.abs(levels[0] - levels[1]).max() < 2e-6
    at = {time: run("probe", tmp_path / "formula.yaml", "--at", "0 m,1.1 m,0 m", "--time", time).stdout for time in ("0 s", "17.24137931 us")}
    assert "34.64 uT" in at["0 s"] and "-34.64 uT" in at["17.24137931 us"]


MAGNET = """rabiline: 1
species: {{name: silver, mass: 107.868 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: -28.0250 GHz/T, source: the electron's moment alone}}
law: quantum
source:
  speed: {{kind: single, value: 600 m/s}}
  opening: {{width: 10 um, height: 10 um}}
  direction: parallel
parts:
  - {{name: magnet, kind: gradient_magnet, at: 0.1 m, length: 0.1 m, field: 0.5 T, gradient: 100 T/m{gap}}}
{more}  - {{name: D, kind: detector, at: 1 m, width: 1 cm, height: 1 cm, bins: [1, 1000]}}
particles: 4000
seed: 1
"""


def lines(folder: Path, more: str = "", gap: str = "") -> tuple[float, float]:
    """The mean height of each of two lines."""
    path = folder / "magnet.yaml"
    path.write_text(MAGNET.format(more=more, gap=gap))
    out = run("run", path, "-o", folder / "magnet.h5", "--progress", "none")
    assert out.returncode == 0, out.stderr
    with h5py.File(folder / "magnet.h5") as file:
        z, counts = file["entry/D_z/z"][:], file["entry/D_z/counts"][:]
    return tuple(np.average(z[side], weights=counts[side]) if counts[side].sum() else np.nan for side in (z > 0, z < 0))


def test_a_field_across_that_of_a_magnet_turns_the_force_to_the_gradient_of_their_sum(tmp_path: Path) -> None:
    alone = lines(tmp_path)
    field = "  - {{name: B, kind: uniform_field, at: 0 m, length: 0.6 m, field: 0.5 T, direction: {}}}\n"
    along, across = lines(tmp_path, field.format("z")), lines(tmp_path, field.format("x"))
    assert np.allclose(along, alone, rtol=2e-4)
    assert np.allclose(np.subtract(*across) / np.subtract(*alone), np.sqrt(0.5), rtol=1e-3)  # Bz/|B| of dBz/dz


def test_two_magnets_at_one_place_push_by_the_sum_of_their_fields(tmp_path: Path) -> None:
    alone = lines(tmp_path)
    again = "  - {name: second, kind: gradient_magnet, at: 0.1 m, length: 0.1 m, field: 0.5 T, gradient: 50 T/m}\n"
    assert np.allclose(lines(tmp_path, again), 1.5 * np.array(alone), rtol=1e-3)


def test_the_gap_of_a_magnet_that_is_one_field_among_others_stops_what_touches_it(tmp_path: Path) -> None:
    field = "  - {name: B, kind: uniform_field, at: 0 m, length: 0.6 m, field: 1 mT}\n"
    up, down = lines(tmp_path, field, ", gap: {width: 1 mm, height: 1 mm}, offset: {z: 0.46 mm}")
    assert up > 0 and np.isnan(down)


def test_tallies_know_how_adiabatic_a_path_was_and_where(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: uniform_field, length: 0.1 m, field: 0 T, direction: y, gradient: {longitudinal: 3 T/m}, offset: {x: 1 mm}")
    text = path.read_text().replace("width: 0.2 mm, height: 0.2 mm", "width: 1 nm, height: 1 nm").replace(
        "bins: [10, 10]", "bins: [1, 1], tallies: [{name: a, axes: [{quantity: adiabaticity, from: 0, to: 1, bins: 1000}]}, "
        "{name: p, axes: [{quantity: adiabaticity_y, from: 1 m, to: 1.1 m, bins: 1000}]}]")
    path.write_text(text)
    out = run("run", path, "-o", tmp_path / "a.h5", "--progress", "none")
    assert out.returncode == 0, out.stderr
    with h5py.File(tmp_path / "a.h5") as file:
        found = [name for name in file["entry"] if name in ("D_a", "D_p")]
        assert len(found) == 2
        least, place = (int(np.argmax(file[f"entry/{name}/counts"][:])) for name in ("D_a", "D_p"))
    expected = 2 * np.pi * 29.16469e6 * 3 * (1e-3) ** 2 / (4 * 1000)  # gamma (G r/2)^2 over v G
    assert abs((least + 0.5) * 1e-3 - expected) < 1e-3
    assert abs(1 + (place + 0.5) * 1e-4 - 1.05) < 2e-3


def test_the_last_face_of_a_formula_is_not_seen_by_the_adiabaticity(tmp_path: Path) -> None:
    path = experiment(tmp_path, f"kind: formula_field, formula: {{Bx: 2e-4, Bz: 1e-4*(y - 0.017), width: 2 cm, height: 2 cm, length: 0.4 m, step: 2 mm}}")
    path.write_text(path.read_text().replace("bins: [10, 10]", "bins: [1, 1], tallies: [{name: a, axes: [{quantity: adiabaticity, from: 0, to: 1000, bins: 1}]}]"))
    levels_of(path)
    with h5py.File(path.with_suffix(".h5")) as file:
        expected = 2 * np.pi * 29.16469e6 * 2e-4**2 / (1e-4 * 1000)  # gamma B_x^2 over v G
        assert file["entry/D_a/adiabaticity_mean"][()].item() == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("approximation", ["none", "rotating_wave"])
def test_a_falling_spin_reads_the_slopes_of_a_drive_where_it_is(tmp_path: Path, approximation: str) -> None:
    """On its parabola; the steps that a gradient of next to nothing asks for do so without that."""
    field = f"kind: uniform_field, length: 0.4 m, field: 20 uT}}\n  - {{name: R, kind: oscillating_field, at: 1.1 m, length: 0.2 m, amplitude: 2 uT, frequency: 583.3 Hz, " \
            f"approximation: {approximation}, phase: 0.2 rad, phase_gradient: {{z: 3 deg/mm}}, amplitude_gradient: {{z: 2 1/m}}"
    paths = [experiment(tmp_path, field + more, name) for name, more in (
        ("closed.yaml", ""), ("stepped.yaml", "}\n  - {name: G, kind: uniform_field, at: 1 m, length: 0.4 m, field: 0 T, gradient: {transverse: 1e-9 uT/m}"))]
    for path in paths:
        path.write_text(path.read_text().replace("1000 m/s", "40 m/s").replace("parallel", "parallel\n  spin: {kind: polarised, axis: [1, 0, 1], degree: 1}")
                        .replace("width: 1 cm, height: 1 cm, bins", "radius: 1 m, bins").replace("seed: 1", "seed: 1\ngravity: 9.81 m/s^2"))
    levels = [levels_of(path) for path in paths]
    assert np.abs(levels[0] - levels[1]).max() < 1e-5


def test_a_picture_of_a_line_has_edges_where_the_field_has(tmp_path: Path) -> None:
    """Within a thousandth of the line."""
    path = experiment(tmp_path, "kind: uniform_field, length: 0.3 m, field: 1 mT")
    assert run("probe", path, "--along", "y", "--from", "0 m", "--to", "2 m", "-o", tmp_path / "b.svg").returncode == 0
    lines = re.findall(r'<path d="(M [^"]+)" clip-path[^>]*fill: none', (tmp_path / "b.svg").read_text())
    places = [np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", line), dtype=float) for line in lines]
    flanks = [abs(step[0]) for line in places for step in np.diff(line, axis=0) if step[0] != 0 and abs(step[1]) > 100]
    assert len(flanks) == 4 and max(flanks) < 0.002 * np.ptp(places[-1][:, 0])
