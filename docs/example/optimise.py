"""Where six sextupoles bring the most hydrogen into a tube: python3 docs/example/optimise.py [STEPS]"""
import sys
from pathlib import Path

import rabiline
from scipy.optimize import minimize

source = rabiline.load(Path(__file__).with_name("sextupole-source.yaml"))
names = [f"S{i}.at" for i in range(1, 7)]
start = [source.value(name) for name in names]


def lost(places):
    magnets = source.set(dict(zip(names, places)))
    if any("one inside the other" in warning for warning in magnets.check().warnings):
        return 1.0
    return 1 - magnets.fly().detected


best = minimize(lost, start, method="Nelder-Mead", options={"maxfev": int((sys.argv[1:] or [200])[0]), "initial_simplex": [
    start, *([x + 0.03 * (i == k) for i, x in enumerate(start)] for k in range(6))]})
print(f"detected {1 - lost(start):.4f} at first, {1 - best.fun:.4f} with", dict(zip(names, best.x.round(4))))
