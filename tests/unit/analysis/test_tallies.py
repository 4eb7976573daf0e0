"""Tallies in words and pictures: the units in which they were written, and what they are summed over."""
from __future__ import annotations

import numpy as np
import pytest
from matplotlib import pyplot as plt

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402

BEAM = """
rabiline: 1
title: tallies
species: neutron
law: quantum
source: {speed: {kind: gaussian, mean: 800 m/s, sigma: 40 m/s}, opening: {width: 1 cm, height: 4 cm}, direction: {kind: box, x: 5 mrad, z: 5 mrad}}
parts:
  - name: mon
    kind: monitor
    at: 3.5 m
    radius: 0.2 m
    tallies:
      - {name: energies, axes: [{quantity: energy, from: 2 meV, to: 5 meV, bins: 30}]}
      - {name: waves, axes: [{quantity: wavelength, from: 3 angstrom, to: 7 angstrom, bins: 30}]}
      - {name: angles, axes: [{quantity: angle_x, from: -1 deg, to: 1 deg, bins: 30}]}
      - {name: three, axes: [{quantity: angle_x, from: -10 mrad, to: 10 mrad, bins: 10}, {quantity: energy, from: 2e-22 J, to: 8e-22 J, bins: 10},
         {quantity: time_of_flight, from: 3 ms, to: 6 ms, bins: 10}]}
  - {name: det, kind: detector, at: 4 m, width: 6 cm, height: 15 cm, bins: [1, 1]}
particles: 5000
seed: 4
"""


@pytest.fixture(scope="module")
def flown() -> object:
    return rabiline.load(BEAM).run()


@pytest.mark.parametrize(("tally", "unit", "mean"), [("energies", "meV", 3.36), ("waves", "angstrom", 4.95), ("angles", "deg", 0.0)])
def test_an_axis_is_summed_up_and_drawn_in_the_unit_in_which_it_was_written(flown: object, tally: str, unit: str, mean: float) -> None:
    axis, = flown.tallies[f"mon_{tally}"].axes
    told = axis.text(axis.mean[0], axis.mean_errors[0])
    assert told.endswith(f" {unit}") and float(told.split()[0]) == pytest.approx(mean, abs=0.01) and f"mean {told}, " in flown.summary()
    figure = flown.plot(kind="tally", name=f"mon_{tally}")
    assert figure.axes[0].get_xlabel().endswith(f"({unit})")
    plt.close(figure)


def test_tallies_of_one_quantity_have_each_its_own_unit_and_no_energy_is_in_joules(flown: object) -> None:
    assert [axis.scale.unit for axis in flown.tallies["mon_three"].axes] == ["mrad", "meV", "ms"]
    assert " J" not in flown.summary()


@pytest.mark.parametrize(("options", "title"), [
    ({}, "summed over time of flight"), ({"axes": "energy"}, "summed over angle x and time of flight"),
    ({"axes": "energy,time_of_flight"}, "summed over angle x")])
def test_a_picture_says_what_it_is_summed_over(flown: object, options: dict[str, str], title: str) -> None:
    figure = flown.plot(kind="tally", name="mon_three", **options)
    assert figure._suptitle.get_text() == f"tallies: three of mon\n{title}"
    assert "summed" not in flown.plot(kind="tally", name="mon_waves")._suptitle.get_text()
    plt.close("all")


def test_a_tally_over_the_scan_says_what_it_is_summed_over() -> None:
    scanned = rabiline.load(BEAM).set(particles=100).scan("source.speed.mean", "700 m/s:900 m/s:3").run()
    figure = scanned.plot(kind="tally", name="mon_three", points="all", axes="energy")
    assert figure._suptitle.get_text().endswith("summed over angle x and time of flight")
    assert np.isfinite(figure.axes[0].get_ylim()).all()
    plt.close(figure)


def test_a_tally_over_one_of_two_scanned_axes_says_where_the_other_stands() -> None:
    scanned = rabiline.load(BEAM).set(particles=100).scan("source.speed.mean", "700 m/s:900 m/s:3").scan("mon.radius", ["9 mm", "8 mm"]).run()
    figure = scanned.plot(kind="tally", name="mon_energies", points="all")
    assert "at mon.radius = 9 mm" in figure._suptitle.get_text()
    plt.close(figure)


def test_a_tally_over_a_scan_in_any_order_is_that_over_a_rising_one() -> None:
    meshes = []
    for values in (["700 m/s", "800 m/s", "900 m/s"], ["900 m/s", "700 m/s", "800 m/s"]):
        figure = rabiline.load(BEAM).set(particles=500).scan("source.speed.mean", values).run().plot(kind="tally", name="mon_energies", points="all")
        meshes.append(figure.axes[0].collections[0])
        plt.close(figure)
    np.testing.assert_array_equal(meshes[0].get_array(), meshes[1].get_array())
    np.testing.assert_array_equal(meshes[0].get_coordinates(), meshes[1].get_coordinates())


def test_levels_are_called_so_and_their_counts_have_no_powers_of_ten() -> None:
    beam = """
rabiline: 1
title: levels
species: Li-7 atom
law: quantum
source: {speed: {kind: single, value: 800 m/s}, opening: {radius: 1 mm}, direction: parallel}
parts:
  - {name: C, kind: uniform_field, at: 0.1 m, length: 0.5 m, field: 1 mT}
  - {name: det, kind: detector, at: 1 m, width: 1 cm, height: 1 cm, bins: [1, 1], tallies: [{name: states, axes: [prepared_level, level]}]}
particles: 20000
seed: 4
"""
    figure = rabiline.load(beam).run().plot(kind="tally", name="det_states")
    panel = figure.axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("level in which it was prepared", "level in which it is found")
    numbers = [text.get_text() for text in panel.texts]
    assert sum(map(float, numbers)) == 20000 and not any("e" in number for number in numbers)
    plt.close(figure)
