"""Where six sextupoles bring the most hydrogen into a tube: python3 docs/example/optimise.py [STEPS]"""
import sys
from pathlib import Path

import rabiline
from scipy.optimize import minimize

source = rabiline.load(Path(__file__).with_name("sextupole-source.yaml"))
names = [f"S{i}.at" for i in range(1, 7)]
start, lengths = ([source.value(f"S{i}.{key}") for i in range(1, 7)] for key in ("at", "length"))


def lost(places):
    ends = [0.021, *(at + length for at, length in zip(places, lengths))]  # of the skimmer and the magnets [m]
    if any(at < end for at, end in zip([*places, 1.30], ends)):  # one would stand inside the other
        return 1.0
    return 1 - source.set(dict(zip(names, places))).fly().detected


best = minimize(lost, start, method="Nelder-Mead", options={"maxfev": int((sys.argv[1:] or [200])[0]), "initial_simplex": [
    start, *([x + 0.03 * (i == k) for i, x in enumerate(start)] for k in range(6))]})
print(f"detected {1 - lost(start):.4f} at first, {1 - best.fun:.4f} with", dict(zip(names, best.x.round(4))))
