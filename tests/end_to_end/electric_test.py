"""Electric fields: charges and spins in them against scipy's DOP853, `probe`, `check`, maps, and what is refused."""

import json
import random
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from constants import CHARGE, DALTON, GAMMA, HBAR, NEUTRON, PROTON
from experiments import EXPERIMENTS, crossings
from experiments import RABILINE as PROGRAM
from scipy.integrate import solve_ivp

LIGHT = 299792458.0
E_CM = 0.01 * CHARGE
MUON, GAMMA_MUON = 0.1134289257 * DALTON, 2 * np.pi * 135.5388094e6
# mass [kg], charge [C], gamma [rad/(s T)], d [C m], slowest and fastest [m/s], E [V/m], B [T]
SPECIES = {
    "neutron": (NEUTRON, 0.0, GAMMA, 0.0, 100, 2000, 3e7, 3e-5),
    "dipole": (NEUTRON, 0.0, GAMMA, 1e-18 * E_CM, 100, 2000, 1e6, 3e-5),
    "proton": (PROTON, CHARGE, 2 * np.pi * 42.577478461e6, 0.0, 3e5, 3e6, 2e4, 5e-3),
    "muon": (MUON, CHARGE, GAMMA_MUON, 0.0, 1e6, 1e7, 3e4, 3e-3),
}


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


def unit(draw):
    v = np.array([draw.gauss(0, 1) for _ in range(3)])
    return v / np.linalg.norm(v)


class Setup:
    """A beamline of uniform fields, some of them electric, and at times one that rotates; and the same as equations."""

    def __init__(self, seed):
        draw = random.Random(seed)
        self.name = draw.choice(list(SPECIES))
        self.mass, self.charge, self.gamma, self.dipole, slowest, fastest, electric, magnetic = SPECIES[self.name]
        self.law = draw.choice(["quantum", "classical"] if self.charge else ["quantum", "classical", "torque", "larmor"])
        self.kappa = draw.uniform(-1, 1) if self.law in ("torque", "larmor") else 0.0
        speed = slowest * (fastest / slowest) ** draw.random()
        self.fields, parts = [], []  # begin, end, B, E
        for i in range(draw.randint(2, 4)):
            begin, length, along = draw.uniform(0.05, 0.4), draw.uniform(0.1, 0.3), unit(draw)
            is_electric = i % 2 == 0
            size = draw.uniform(0.1, 1) * (electric if is_electric else magnetic)
            none = np.zeros(3)
            self.fields.append((begin, begin + length, none if is_electric else size * along, size * along if is_electric else none))
            parts.append({"name": f"field{i}", "kind": "electric_field" if is_electric else "uniform_field", "at": f"{begin!r} m",
                          "length": f"{length!r} m", "field": f"{size!r} {'V/m' if is_electric else 'T'}", "direction": along.tolist()})
        self.drive = None
        if draw.random() < 0.5:
            amplitude, turns = 0.3 * magnetic, 4 * draw.random()
            self.drive = (0.2, 0.4, amplitude, turns * speed / 0.2, 0.5)
            parts.append({"name": "drive", "kind": "rotating_field", "at": "0.2 m", "length": "0.2 m", "amplitude": f"{amplitude!r} T",
                          "frequency": f"{self.drive[3]!r} Hz", "sense": "positive", "phase": "0.5 rad"})
        species = {"muon": "muon+"}.get(self.name, self.name)
        if self.name == "dipole":
            species = {"name": "with a dipole", "mass": f"{NEUTRON / DALTON!r} u", "charge": "0 e", "spin": "1/2",
                       "gyromagnetic_ratio": f"{GAMMA!r} rad/s/T", "electric_dipole_moment": "1e-18 e cm"}
        law = {"name": "dorado", "closure": self.law, "kappa": self.kappa} if self.kappa else self.law
        parts.append({"name": "screen", "kind": "detector", "at": "0.8 m", "width": "1 m", "height": "1 m", "bins": [1, 1]})
        self.beamline = {"rabiline": 1, "title": f"random {seed}", "species": species, "law": law, "particles": 4, "seed": seed, "parts": parts,
                         "source": {"speed": {"kind": "single", "value": f"{speed!r} m/s"}, "opening": {"width": "4 mm", "height": "4 mm"},
                                    "direction": {"kind": "cone", "half_angle": "5 mrad"},
                                    "spin": {"kind": "polarised", "axis": draw.choice("xyz"), "degree": 1}}}

    def rates(self, t, state, inside):
        """d(r, v, S)/dt by Newton, Lorentz, Bargmann-Michel-Telegdi to first order in v/c, and H = -d sigma.E."""
        r, v, spin = state[:3], state[3:6], state[6:]
        b, e = sum((f[2] for f in inside), np.zeros(3)), sum((f[3] for f in inside), np.zeros(3))
        if self.drive and self.drive[0] <= self.middle <= self.drive[1]:
            angle = 2 * np.pi * self.drive[3] * t + self.drive[4]
            b = b + self.drive[2] * np.array([np.cos(angle), np.sin(angle), 0])
        thomas = self.charge / (2 * self.mass)
        turn = -self.gamma * b + (self.gamma - thomas) / LIGHT**2 * np.cross(v, e) - 2 * self.dipole / HBAR * e
        push = self.charge / self.mass * (e + np.cross(v, b))
        if self.law in ("torque", "larmor"):
            joint = turn - (turn @ spin) * spin if self.law == "torque" else turn
            push = self.kappa * np.cross(joint, v)
        return np.concatenate([v, push, np.cross(turn, spin)])

    def fly(self, t, state, end):
        """The state at y = end; None where it turns back."""
        edges = sorted({y for f in self.fields for y in f[:2]} | ({*self.drive[:2]} if self.drive else set()) | {end})
        speed = np.linalg.norm(state[3:6])
        size = np.array([1.0] * 3 + [speed] * 3 + [1.0] * 3)
        for edge in edges:
            y = state[1]
            if edge <= y:
                continue
            self.middle = (y + edge) / 2
            inside = [f for f in self.fields if f[0] <= self.middle <= f[1]]

            def meets(_t, q, _inside, edge=edge):
                return q[1] - edge

            meets.terminal = True
            found = solve_ivp(self.rates, (t, t + 20 * (edge - y) / speed), state, "DOP853", rtol=1e-12, atol=1e-13 * size, events=meets,
                              args=(inside,), max_step=(edge - y) / speed / 4)
            if not found.t_events[0].size:
                return None
            t, state = found.t_events[0][0], found.y_events[0][0]
        return state


def deviation(seed, folder):
    """The largest of place over the way, direction and spin, and how many particles were compared."""
    setup = Setup(seed)
    path, tracks = folder / "random.yaml", folder / "random.h5"
    path.write_text(json.dumps(setup.beamline) + "\n")
    done = run("trace", path, "-n", "4", "-o", tracks)
    assert done.returncode == 0, (seed, done.stderr)
    worst, compared = 0.0, 0
    with h5py.File(tracks) as file:
        for name, track in file["entry"].items():
            if not name.startswith("particle_") or track.attrs["fate"] != "detected":
                continue
            rows = np.array([track[key][:] for key in ("x", "y", "z", "vx", "vy", "vz", "sx", "sy", "sz")])
            end = setup.fly(track["t"][0], rows[:, 0], 0.8)
            if end is None:
                continue
            off = end - rows[:, -1]
            worst = max(worst, np.linalg.norm(off[:3]) / 0.8, np.linalg.norm(off[3:6]) / np.linalg.norm(end[3:6]), np.linalg.norm(off[6:]))
            compared += 1
    return worst, compared


def test_charges_and_spins_fly_as_an_integration_of_their_equations_does(tmp_path: Path) -> None:
    compared = 0
    for seed in range(1, 41):
        worst, particles = deviation(seed, tmp_path)
        assert worst < 1e-6, seed
        compared += particles
    assert compared > 100


BEAMLINE = """rabiline: 1
species: {species}
law: {law}
source:
  speed: {{kind: single, value: {speed}}}
  opening: {{width: 0.2 mm, height: 0.2 mm}}
  direction: parallel
parts:
{parts}
  - {{name: screen, kind: detector, at: 2 m, width: 1 cm, height: 1 cm, bins: [1, 1]}}
particles: 10
seed: 1
"""


def beamline(folder, *parts, species="neutron", law="quantum", speed="1000 m/s"):
    path = folder / "electric.yaml"
    rows = "\n".join(f"  - {{{part}}}" for part in parts)
    path.write_text(BEAMLINE.format(species=species, law=law, speed=speed, parts=rows))
    return path


PLATES = "name: plates, kind: electric_field, at: 1 m, length: 0.5 m, field: 10 kV/cm"


def test_probe_tells_the_electric_field_and_whose_it_is(tmp_path: Path) -> None:
    path = beamline(tmp_path, "name: B, kind: uniform_field, at: 0.5 m, length: 1 m, field: 10 uT", PLATES)
    lines = run("probe", path, "--at", "0,1.2 m,0").stdout.splitlines()
    assert lines[1:5] == ["  B = (0 T, 0 T, 10 uT), |B| = 10 uT", "    B                (0 T, 0 T, 10 uT), |B| = 10 uT",
                          "  E = (0 V/m, 0 V/m, 1 MV/m), |E| = 1 MV/m",
                          "    plates           (0 V/m, 0 V/m, 1 MV/m), |E| = 1 MV/m"]
    assert "E =" not in run("probe", path, "--at", "0,0.7 m,0").stdout
    table = run("probe", path, "--along", "y", "--from", "0.9 m", "--to", "1.1 m", "--points", "3").stdout.splitlines()
    assert table[0].endswith("Ex [V/m],Ey [V/m],Ez [V/m]")
    assert run("probe", path, "--along", "y", "--from", "0.9 m", "--to", "1.1 m", "-o", tmp_path / "field.png").returncode == 0
    assert (tmp_path / "field.png").read_bytes().startswith(b"\x89PNG")
    assert [float(row.split(",")[-1]) for row in table[1:]] == [0, 1e6, 1e6]


def test_check_tells_what_an_electric_field_does_to_spins_and_charges(tmp_path: Path) -> None:
    told = run("check", beamline(tmp_path, PLATES, "name: B, kind: uniform_field, at: 0.2 m, length: 0.5 m, field: 10 uT"))
    assert told.returncode == 0 and told.stderr == ""
    # B' = v E/c^2 = 11.13 nT, gamma B' L/v = 0.05841 deg
    assert "E = (0 V/m, 0 V/m, 1 MV/m), its mean on the axis: in flight a spin meets v x E/c^2 = 11.13 nT of it as a magnetic field, and its phase changes by up to 0.05841 deg\n" in told.stdout
    assert "  plates           electric_field   turns spins\n" in told.stdout
    assert "  B                uniform_field    turns spins\n" in told.stdout
    protons = run("check", beamline(tmp_path, PLATES + ", direction: y", species="proton", speed="1e6 m/s")).stdout
    assert "the charge gains 500 keV" in protons
    assert "  plates           electric_field   turns spins and moves particles\n" in protons


@pytest.mark.parametrize(("parts", "arguments", "message"), [
    (PLATES.replace("10 kV/cm", "10 mT"), {}, "electric field"),
    (PLATES, {"species": "Cs-133 atom"}, "`plates` is an electric field, and what it does to the levels of `Cs-133 atom`"),
    (PLATES, {"species": "Cs-133 atom", "law": "classical"}, "Stark"),
    (PLATES, {"species": "proton", "law": "dorado"}, "undefined"),
    (PLATES + ", direction: -y", {"species": "electron", "speed": "1e6 m/s"}, "faster than 0.05 c"),
    (PLATES, {"species": "{name: ion, mass: 2 u, charge: 1 e, spin: 1/2, gyromagnetic_ratio: 10 MHz/T, electric_dipole_moment: 1 e cm}"},
     "v x B"),
])
def test_what_is_not_modelled_in_electric_fields_is_refused_with_its_place(tmp_path: Path, parts, arguments, message) -> None:
    told = run("check", beamline(tmp_path, parts, **arguments))
    assert told.returncode == 2
    assert message in told.stderr and "electric.yaml:" in told.stderr and "help:" in told.stderr


def write_map(path, fields, names="Ex Ey Ez", unit="kV/m"):
    axes = [np.linspace(-0.01, 0.01, 5), np.linspace(0, 0.5, 6), np.linspace(-0.01, 0.01, 5)]
    rows = [f"{x:.9g},{y:.9g},{z:.9g},{','.join(f'{value:.12g}' for value in fields(x, y, z))}" for x in axes[0] for y in axes[1] for z in axes[2]]
    header = ",".join(["x [m]", "y [m]", "z [m]", *(f"{name} [{unit}]" for name in names.split())])
    path.write_text(header + "\n" + "\n".join(rows) + "\n")


def test_a_map_of_an_electric_field_acts_as_the_field_that_it_was_made_of(tmp_path: Path) -> None:
    write_map(tmp_path / "plates.csv", lambda x, y, z: (3, 0, 1000))
    spins = []
    for part in ("name: M, kind: field_map, at: 1 m, map: plates.csv",
                 "name: E, kind: electric_field, at: 1 m, length: 0.5 m, field: 1000.0045 kV/m, tilt: {y: 0.00299999 rad}"):
        path = beamline(tmp_path, "name: B, kind: uniform_field, at: 0.5 m, length: 1.2 m, field: 1 uT, direction: x", part)
        assert run("trace", path, "-n", "1", "-o", tmp_path / "t.h5").returncode == 0
        with h5py.File(tmp_path / "t.h5") as file:
            spins.append([file[f"entry/particle_0/s{axis}"][-1] for axis in "xyz"])
    assert np.abs(np.subtract(*spins)).max() < 1e-9
    path = beamline(tmp_path, "name: M, kind: field_map, at: 1 m, map: plates.csv")
    assert "|E| = 1 MV/m" in run("probe", path, "--at", "1 mm,1.2 m,0").stdout
    assert "M: field_map, 1 m to 1.5 m, up to 1 MV/m on the axis" in run("check", path).stdout


@pytest.mark.parametrize(("names", "unit", "part", "message"), [
    ("Ex Ey Ez", "mT", "map: plates.csv", "`mT` is not a unit of the column `Ex`"),
    ("Ex Ey Bz", "kV/m", "map: plates.csv", "not a unit of the column `Bz`"),
    ("Ex Ey Ez", "kV/m", "map: plates.csv, oscillates: {frequency: 1 kHz, phase: locked}", "stand still"),
    ("Ex Ey Ez", "kV/m", "map: {file: plates.csv, z: same_currents}", "currents have no electric field"),
])
def test_a_map_that_is_half_electric_is_refused(tmp_path: Path, names, unit, part, message) -> None:
    write_map(tmp_path / "plates.csv", lambda x, y, z: (0, 0, 1000), names, unit)
    told = run("check", beamline(tmp_path, f"name: M, kind: field_map, at: 1 m, {part}"))
    assert told.returncode == 2 and message in told.stderr


def levels(file):
    return file["entry/screen_levels/levels"][:]


@pytest.mark.experiment("neutron-edm")
def test_reversing_the_field_shifts_the_fringe_by_the_dipole_moment_and_by_v_cross_e(run):
    file = run("neutron-edm", "--particles", "20000")  # whose speeds know 1/v to 4e-4
    field, stays = file["entry/scan/E_field"][:], levels(file)[:, 0]

    def expected(dipole, angle, speed=154 + 8 * np.linspace(-5, 5, 201)):
        weight = np.exp(-(((speed - 154) / 8) ** 2) / 2)
        edm = -2 * dipole * E_CM / HBAR * np.cos(angle) * 1.8 / speed
        motional = -GAMMA * np.sin(angle) * 1.8 / LIGHT**2
        tip = -GAMMA * 13.2e-6 * 0.1 / speed
        stay = [(1 + np.cos(tip) ** 2 - np.sin(tip) ** 2 * np.sin((edm + motional) * size)) / 2 for size in field]
        return np.array(stay) @ weight / weight.sum()

    slope = np.polyfit(field, stays, 1)[0]
    assert abs(slope / np.polyfit(field, expected(1e-20, 0.1), 1)[0] - 1) < 2e-3
    assert abs(slope / np.polyfit(field, expected(1.01e-20, 0.1), 1)[0] - 1) > 5e-3
    for alone, dipole, angle in (("species.electric_dipole_moment=0 e cm", 0, 0.1), ("E.tilt.y=0 rad", 1e-20, 0)):
        seen = levels(run("neutron-edm", "--particles", "20000", "--set", alone))[:, 0]
        assert abs(np.polyfit(field, seen, 1)[0] / np.polyfit(field, expected(dipole, angle), 1)[0] - 1) < 2e-3
    assert file["entry/field_check/spin"][()] < 1e-6


@pytest.mark.experiment("wien-filter")
def test_a_wien_filter_passes_what_the_closed_form_sends_through_its_slit(run):
    file = run("wien-filter")
    field, passed = file["entry/scan/E_field"][:], file["entry/scan/detected"][:]
    w, v = CHARGE * 10e-3 / PROTON, 1e6

    def beside_the_slit(electric):
        drift = -electric / 10e-3
        d, times = v - drift, np.linspace(1.5e-7, 2.5e-7, 200001)
        t = np.interp(0.2, d / w * np.sin(w * times) + drift * times, times)
        return d * (1 - np.cos(w * t)) / w + 0.5 * d * np.sin(w * t) / (d * np.cos(w * t) + drift)

    places = np.array([beside_the_slit(size) for size in field])
    for edge, found in zip((-0.5e-3, 0.5e-3), crossings(field, passed, 0.5), strict=True):
        assert abs(found - np.interp(edge, places, field)) < 0.05 * abs(field[1] - field[0])
    assert passed[np.argmin(abs(field + 10e3))] == 1 and passed[0] == passed[-1] == 0
