"""Numbers and names as people read them."""
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rabiline.units import base_of, fitting_scale, format_value, law_name, parse_quantity


@pytest.mark.parametrize(("value", "unit", "error", "text"), [
    (291650.0, "Hz", None, "291.65 kHz"),
    (291650.0, "Hz", 12.3, "291.650 ± 0.012 kHz"),
    (9192631770.1, "Hz", 1.1, "9192631770.1 ± 1.1 Hz"),
    (9192631771.543, "Hz", 0.48, "9192631771.54 ± 0.48 Hz"),
    (-139.9905288, "Hz", 1.5e-8, "-139.990528800 ± 0.000000015 Hz"),
    (3e-7, "T", None, "300 nT"),
    (1e-3, "m", None, "1 mm"),
    (0.0, "m", None, "0 m"),
    (1000.0, "m/s", None, "1000 m/s"),
    (0.5, "", 0.01, "0.500 ± 0.010"),
    (-5.2e-3, "m", 1e-4, "-5.20 ± 0.10 mm"),
    (5.3795e-22, "J", 7.6e-25, "3.3576 ± 0.0047 meV"),
    (1.602176634e-19, "J", None, "1 eV"),
    (2.5, "J", 0.1, "2.50 ± 0.10 J"),
])
def test_a_value_is_written_with_a_fitting_prefix(value: float, unit: str, error: float | None, text: str) -> None:
    assert format_value(value, unit, error) == text


def test_an_axis_has_the_prefix_of_its_largest_value() -> None:
    scale = fitting_scale(np.array([266.6e3, 316.6e3]), "Hz")
    assert scale.label("H0.frequency") == "H0.frequency (kHz)"
    assert scale.apply(291.65e3) == pytest.approx(291.65)


def test_a_narrow_scan_is_shown_as_differences_from_its_middle() -> None:
    scale = fitting_scale(9192631770 + np.linspace(-100, 100, 11), "Hz")
    assert scale.label("frequency") == "frequency − 9.19263177 GHz (Hz)"
    assert replace(scale, origin=-scale.origin).label("shift") == "shift + 9.19263177 GHz (Hz)"
    assert scale.apply(9192631870) == pytest.approx(100)


@pytest.mark.parametrize(("text", "value"), [("291.65 kHz", 291650), ("3 mm", 3e-3), ("2.5", 2.5), ("1 m", 1),
                                             ("0.3 µT", 3e-7), ("0.3 uT", 3e-7),
                                             ("3 meV", 4.806529902e-22)])
def test_a_quantity_is_read_with_its_prefix(text: str, value: float) -> None:
    assert parse_quantity(text) == pytest.approx(value)


def test_an_energy_is_read_in_either_unit() -> None:
    assert parse_quantity("1 eV", "J") == parse_quantity("1.602176634e-19 J", "J")
    with pytest.raises(ValueError, match="meV is not a unit of the kind of Hz"):
        parse_quantity("1 meV", "Hz")


def test_energies_of_particles_are_drawn_in_electronvolts() -> None:
    scale = fitting_scale(np.array([2e-22, 8e-22]), "J")
    assert scale.unit == "meV" and scale.apply(1.602176634e-22) == pytest.approx(1)
    assert fitting_scale(5e-22 * (1 + 1e-4 * np.arange(4)), "J").label("energy") == "energy − 3.121191443 meV (neV)"


@pytest.mark.parametrize("text", ["", "fast", "3 parsec", "3 k Hz"])
def test_a_quantity_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(ValueError):
        parse_quantity(text)


def test_a_hypothesis_is_named_one() -> None:
    assert law_name("dorado (torque, kappa = 1)") == "dorado (hypothesis), torque, κ = 1"
    assert law_name("dorado") == "dorado (hypothesis)"
    assert law_name("quantum") == "quantum"


def test_units_of_tables_and_options_are_those_of_files() -> None:
    for text, unit, value in (("2126 G", "T", 0.2126), ("3 mG", "T", 3e-7), ("180 deg", "rad", np.pi), ("5 mrad", "rad", 5e-3), ("2 cm", "m", 0.02), ("90 deg", "deg", np.pi / 2)):
        assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-12)
    with pytest.raises(ValueError, match="deg is not a unit of the kind of T"):
        parse_quantity("1 deg", "T")
    assert base_of("kG") == ("T", pytest.approx(0.1)) and base_of("deg")[0] == "rad" and base_of("K") == ("K", 1.0)


def test_a_value_keeps_the_unit_that_was_written_to_eight_decimals() -> None:
    assert format_value(1e-3, "T", 1.37e-10, ("mT", 1e-3)) == "1.00000000 ± 0.00000014 mT"
