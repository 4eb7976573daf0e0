"""Scans are shown in the unit in which they were written."""
from __future__ import annotations

import numpy as np
import pytest

from rabiline.scan_axes import Axis, written_unit
from rabiline.units import Scale

GAUSS = np.linspace(5e-6, 20e-6, 4)


@pytest.mark.parametrize(("text", "unit", "factor"), [
    ("run a.yaml --scan C.field=50 mG:200 mG:4 -o g.h5", "mG", 1e-7), ("run a.yaml --scan C.field=5uT:20uT:4 -o g.h5", "µT", 1e-6),
    ("run a.yaml --scan C.field,D.field=0.05 G:0.2 G:4", "G", 1e-4), ("run a.yaml --scan C.field=50 mG,100 mG,200 mG", "mG", 1e-7),
    ("scan: {parameter: C.field, from: 50 mG, to: 200 mG, points: 4}", "mG", 1e-7),
    ("scan:\n  parameter: C.field\n  values: [5 uT, 10 uT, 20 uT]\nseed: 1\n", "µT", 1e-6)])
def test_the_unit_is_found_where_the_scan_is_written(text: str, unit: str, factor: float) -> None:
    found = written_unit("C.field, D.field", GAUSS, ["", text])
    assert found is not None and found[0] == unit and found[1] == pytest.approx(factor)


@pytest.mark.parametrize("text", ["", "run a.yaml --scan C.field=50 mG:300 mG:4", "run a.yaml --scan C.field=50 mG:20 uT:4",
                                  "scan: {parameter: D.field, from: 50 mG, to: 200 mG, points: 4}", "--scan C.field=1:2:3"])
def test_another_scan_tells_no_unit(text: str) -> None:
    assert written_unit("C.field", GAUSS, [text]) is None


def test_an_axis_is_shown_as_it_was_written_unless_it_is_narrow() -> None:
    axis = Axis("C.field", "T", GAUSS, (), ("mG", 1e-7))
    assert axis.scale == Scale("mG", 1e-7) and axis.text(1e-5) == "100 mG" and axis.scale.label("C.field") == "C.field (mG)"
    narrow = Axis("f", "Hz", 9.2e9 + np.arange(4.0), (), ("GHz", 1e9))
    assert narrow.scale.unit == "Hz" and narrow.scale.origin > 9e9 and narrow.text(9.2e9 + 1) == "9.200000001 GHz"
    assert Axis("f", "Hz", narrow.values, (), ("Hz", 1.0)).text(9.2e9 + 1) == "9200000001 Hz"
