"""Files with the layout that rabiline writes, filled with numbers that are known beforehand."""
from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

GAMMA = -1.83247171e8  # neutron, rad/(s T)
DORADO = "dorado (torque, kappa = 1)"


@dataclass
class Axis:
    """A scanned parameter, or with `labels` a categorical one."""

    parameter: str
    values: np.ndarray
    units: str = "1"
    labels: list[str] = field(default_factory=list)


def frequencies(points: int = 101) -> Axis:
    """The scan of the suggested experiment."""
    return Axis("H0.frequency", np.linspace(266.6e3, 316.6e3, points), "Hz")


def laws(*names: str) -> Axis:
    """A scan over laws."""
    return Axis("law", np.arange(len(names), dtype=float), labels=list(names))


def dip(frequency: np.ndarray, centre: float = 291.65e3, width: float = 7.3e3, steepness: float = 16) -> np.ndarray:
    """Detected fraction with a dip to zero, `width` wide at half its depth."""
    return 1 - np.exp2(-np.abs(2 * (frequency - centre) / width) ** steepness)


def binomial_errors(fraction: np.ndarray, particles: int) -> np.ndarray:
    """Wilson's standard error: never zero."""
    return np.sqrt(fraction * (1 - fraction) * particles + 0.25) / (particles + 1)


def fly_shared(generator: np.random.Generator, x: np.ndarray, particles: int, centre: float, width: float,
               missing: float, caught: float) -> tuple[np.ndarray, np.ndarray]:
    """[n] and [n, n] The fraction caught at each point, and its covariance from 256 groups, of particles that all
    points share. Each is lost from somewhere below the centre to somewhere above, drawn so that the mean is exactly
    `caught` (1 - `missing` 2^-(2 (x - centre)/width)²): neighbouring points mostly lose the same particles."""
    below, above = width / 2 * np.sqrt(-np.log2(generator.random((2, particles, 1))))
    lost = (x > centre - below) & (x < centre + above) & (generator.random((particles, 1)) < missing)
    hits = (~lost & (generator.random((particles, 1)) < caught)).astype(float)
    groups = np.arange(particles) % 256
    sums = np.zeros((256, x.size))
    np.add.at(sums, groups, hits)
    deviations = (sums - np.bincount(groups, minlength=256)[:, None] * hits.mean(axis=0)) / particles
    return hits.mean(axis=0), deviations.T @ deviations * 256 / 255


def write_data(parent: h5py.Group, name: str, signal: str, values: np.ndarray, errors: np.ndarray,
               axes: list[Axis], title: str = "") -> h5py.Group:
    """An NXdata group: a signal with its errors over axes."""
    group = parent.create_group(name)
    group.attrs["NX_class"] = "NXdata"
    group.attrs["signal"] = signal
    group.attrs["axes"] = [axis.parameter.replace(".", "_") for axis in axes] or ["."]
    group["title"] = title
    group[signal], group[f"{signal}_errors"] = values, errors
    for axis in axes:
        axis_name = axis.parameter.replace(".", "_")
        group[axis_name] = axis.values
        group[axis_name].attrs["units"] = axis.units
        group[axis_name].attrs["parameter"] = axis.parameter
        if axis.labels:
            group[f"{axis_name}_labels"] = np.array(axis.labels, dtype="S")
    return group


def beam_image(detected: np.ndarray, particles: int, bins: int) -> np.ndarray:
    """[points, bins, bins] counts of a beam of 0.2 mm x 1 mm, a little blurred, on a screen of 4 mm x 4 mm."""
    generator = np.random.default_rng(1938)
    edges = np.linspace(-2e-3, 2e-3, bins + 1)
    x = generator.uniform(-1e-4, 1e-4, particles) + generator.normal(0, 5e-5, particles)
    z = generator.uniform(-5e-4, 5e-4, particles) + generator.normal(0, 5e-5, particles)
    numbers, place = np.unique(np.rint(detected * particles).astype(int), return_inverse=True)
    more = [np.histogram2d(x[begin:end], z[begin:end], (edges, edges))[0] for begin, end in zip([0, *numbers], numbers)]
    return np.cumsum(more, axis=0)[place.ravel()]


def write_results(path: Path, axes: list[Axis], detected: np.ndarray, *, law: list[str], particles: int = 10000,
                  detectors: tuple[str, ...] = ("screen",), covariance: np.ndarray | None = None,
                  bins: int = 80, seed: int = 1938) -> Path:
    """A file of `rabiline run`; `detected` is [points] for one detector, [detectors, points] for several."""
    shape = tuple(axis.values.size for axis in axes)
    points = int(np.prod(shape, dtype=int))
    rows = np.reshape(detected, (len(detectors), points))
    leading = [] if len(detectors) == 1 else [Axis("detector_index", np.arange(len(detectors), dtype=float))]
    full = (shape or (1,)) if len(detectors) == 1 else (len(detectors), *shape)
    edges = np.linspace(-2e-3, 2e-3, bins + 1)
    centres = (edges[:-1] + edges[1:]) / 2
    x, z = Axis("x", centres, "m"), Axis("z", centres, "m")
    with h5py.File(path, "w") as file:
        entry = file.create_group("entry")
        entry["title"] = "The experiment suggested to test the theory"
        entry["program_name"] = "rabiline"
        entry["program_name"].attrs["version"] = "0.1.0"
        entry["law"] = np.array(law * (1 if len(law) == points else points), dtype="S")
        entry["species"] = np.array(["neutron"] * points, dtype="S")
        entry["particles"] = np.uint64(particles)
        scan = write_data(entry, "scan", "detected", rows.reshape(full),
                          binomial_errors(rows, particles).reshape(full), leading + axes)
        scan["detector_names"] = np.array(detectors, dtype="S")
        if covariance is not None:
            scan["detected_covariance"] = covariance
        for name, row in zip(detectors, rows):
            counts = beam_image(row, particles, bins)
            for suffix, summed, own in (("", (), [x, z]), ("_x", (2,), [x]), ("_z", (1,), [z])):
                image = counts.sum(axis=summed) if summed else counts
                image = image.reshape(*shape, *image.shape[1:])
                group = write_data(entry, name + suffix, "counts", image, np.sqrt(image), axes + own)
                for axis in own:
                    group[f"{axis.parameter}_edges"] = edges
            level = Axis("level_index", np.array([0.0, 1.0]), labels=["m = +1/2", "m = -1/2"])
            fractions = np.tile([0.0, 1.0], (points, 1)).reshape(*shape, 2)
            write_data(entry, f"{name}_levels", "levels", fractions, np.zeros_like(fractions), axes + [level])
        _write_fates(entry, rows, particles)
        simulation = entry.create_group("simulation")
        simulation["seed"], simulation["threads"], simulation["version"] = np.uint64(seed), np.uint64(2), "0.1.0"
        simulation["arguments"] = np.array(["rabiline", "run", "paper.yaml"], dtype="S")
    return path


def _write_fates(entry: h5py.Group, rows: np.ndarray, particles: int) -> None:
    fates = entry.create_group("fates")
    fates["fate"] = np.array(["detected"] * len(rows) + ["passed"], dtype="S")
    fates["where"] = np.array([f"detector {i}" for i in range(len(rows))] + [""], dtype="S")
    fates["particles"] = np.vstack([rows, 1 - rows.sum(axis=0)]) * particles
    fates["emitted"] = np.full(rows.shape[1], float(particles))


def align(flight: dict[str, np.ndarray], record: int, before: tuple[float, float, float]) -> dict[str, np.ndarray]:
    """The flight with another spin before `record`, at which an alignment changes it in no time."""
    longer = {name: np.insert(values, record, values[record]) for name, values in flight.items()}
    for name, value in zip(("sx", "sy", "sz"), before):
        longer[name][:record + 1] = value
    return longer


def fly(law: str, frequency: float, x: float = 0.0, z: float = 0.0, phase: float = 0.0) -> dict[str, np.ndarray]:
    """A neutron through the suggested experiment, by Runge and Kutta's method: B along z from 0.30 m to 0.55 m, the
    rotating field from 0.35 m on, plane at 1.2 m. The vector law is the hypothesis `dorado`, closure torque."""
    field, amplitude, speed = 10e-3, 0.3e-6, 1000.0
    sense = 2 * np.pi * frequency

    def magnetic(t: float, y: float) -> np.ndarray:
        rotating = amplitude if 0.35 <= y < 0.55 else 0.0
        angle = sense * t + phase
        return np.array([rotating * np.cos(angle), rotating * np.sin(angle), field if 0.30 <= y < 0.55 else 0.0])

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        spin_rate = GAMMA * np.cross(state[6:], magnetic(t, state[1]))
        return np.concatenate([state[3:6], np.cross(np.cross(state[6:], spin_rate), state[3:6]), spin_rate])

    state = np.array([x, 0.0, z, 0.0, speed, 0.0, 0.0, 0.0, -1.0])
    rows, t = [(0.0, *state)], 0.0
    while state[1] < 1.2:
        if law == "quantum" or not 0.30 <= state[1] < 0.55:
            step = (0.30 if state[1] < 0.30 else 1.2) - state[1]
            step = max(step, 1e-6) / state[4]
            state = state + step * np.concatenate([state[3:6], np.zeros(6)])
        else:
            step = 5e-8
            k1 = slope(t, state)
            k2 = slope(t + step / 2, state + step / 2 * k1)
            k3 = slope(t + step / 2, state + step / 2 * k2)
            k4 = slope(t + step, state + step * k3)
            state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        t += step
        rows.append((t, *state))
    table = np.array(rows)
    if law == "quantum":
        table[:, 7:] = np.nan
    return dict(zip("t x y z vx vy vz sx sy sz".split(), table.T))


def write_tracks(path: Path, flights: list[dict[str, np.ndarray]], law: str = "") -> Path:
    """A file of `rabiline trace`."""
    with h5py.File(path, "w") as file:
        entry = file.create_group("entry")
        entry["title"] = "The experiment suggested to test the theory"
        if law:
            entry["law"] = law
        for number, flight in enumerate(flights):
            group = entry.create_group(f"particle_{number}")
            for name, values in flight.items():
                group[name] = values
            hit = abs(flight["x"][-1]) < 2e-3
            group.attrs.update({"particle": np.uint64(number), "law": law, "species": "neutron",
                                "fate": "detected" if hit else "passed", "where": "screen" if hit else ""})
    return path
