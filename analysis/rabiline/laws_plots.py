"""Where two laws differ, as a picture: what each expects, and what each place adds to the likelihood ratio, signed."""
from __future__ import annotations

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure, SubFigure

from . import style
from .laws_report import Beam, against_data, unit_models
from .likelihood import separation
from .observed import Observation
from .style import COUNTS, GREY, INK, LAWS, looks
from .templates import Screen, Templates, spread_over_bins
from .units import Scale, fitting_scale, law_name


@style.in_proportion
def draw_laws(made: Templates, beam: Beam, pair: tuple[int, int], data: Observation | None,
              title: str | None) -> Figure:
    """One column for each law and one for the difference, above, where there are places to show; below, fractions with
    error bars and the difference along the scan or along the detector. Of the first detector."""
    one, other = pair
    screen = made.screens[0]
    signed = _signed(made, beam, one, other)
    names = [law_name(made.names[i]) for i in pair]
    colours = [look.colour for look in looks([made.names[i] for i in pair])]
    maps = min(signed.shape[1:]) > 1 or (max(signed.shape[1:]) > 1 and made.points > 1)
    figure = plt.figure(figsize=(10.6, 8.0 if maps else 5.2), layout="constrained")
    parts = figure.subfigures(2, 1, height_ratios=[1, 1.45]) if maps else [figure]
    if maps:
        _draw_maps(parts[0], parts[0].subplots(1, 3), made, screen, pair, signed, names)
    along = [None] if made.points > 1 or max(signed.shape[1:]) == 1 else \
        [name for place, name in enumerate("xz") if signed.shape[1 + place] > 1]
    panels = parts[-1].subplots(2, len(along), sharex="col", squeeze=False, height_ratios=[1, 0.75])
    for (upper, lower), name in zip(panels.T, along):
        _draw_lines(upper, lower, made, screen, pair, signed, name, (names, colours))
        if data is not None:
            _draw_data(upper, made, beam, data, screen, name, pair[0])
    panels[0, 0].set_title(" ")  # room for the legend, which is wider than one of two panels
    panels[0, 0].legend(loc="lower left", bbox_to_anchor=(0, 1.01), ncol=3, borderaxespad=0).set_in_layout(False)
    several = f", detector {screen.name}" if len(made.screens) > 1 else ""
    style.write_title(figure, (title or made.title) + several)
    return figure


def _signed(made: Templates, beam: Beam, one: int, other: int) -> np.ndarray:
    """[points, nx, nz] Each bin's share of q if the first law is true, above 0 where this expects more."""
    found = unit_models(made, beam)
    way = separation(found[one], found[other])
    cells = int(made.screens[0].cells.max()) + 1
    total = way.contributions.sum() or 1.0
    other_expected = found[other].at(found[one].expected).expected
    shares = np.sign(found[one].expected - other_expected) * way.contributions / total
    return spread_over_bins(made.screens[0], shares[:cells])


def _draw_maps(figure: SubFigure, axes: np.ndarray, made: Templates, screen: Screen, pair: tuple[int, int],
               signed: np.ndarray, names: list[str]) -> None:
    image = min(signed.shape[1:]) > 1
    if image:
        scales = [fitting_scale(edges, "m") for edges in screen.edges]
        across, up = (scale.apply(edges) for scale, edges in zip(scales, screen.edges))
        labels = [scale.label(name) for scale, name in zip(scales, "xz")]
        templates = [screen.counts[i].mean(axis=0).T for i in pair]
        difference = signed.sum(axis=0).T
    else:
        place = 0 if signed.shape[1] > 1 else 1
        scale, points = fitting_scale(screen.edges[place], "m"), _scale(made)
        up, across = scale.apply(screen.edges[place]), _between(points.apply(made.axis.values))
        labels = [points.label(made.axis.parameter), scale.label("xz"[place])]
        templates = [screen.counts[i].reshape(made.points, -1).T for i in pair]
        difference = signed.reshape(made.points, -1).T
    most = max(float(template.max()) for template in templates) or 1.0
    for ax, template, name in zip(axes, templates, names):
        mesh = ax.pcolormesh(across, up, template, cmap=COUNTS, vmin=0, vmax=most, rasterized=True)
        ax.set_title(name.replace(", ", "\n", 1))
    figure.colorbar(mesh, ax=axes[:2], label="counts in a bin / emitted" + ("\nmean over the scan" if image
                                                                                       and made.points > 1 else ""))
    limit = float(np.abs(difference).max()) * 100 or 1.0
    colour = [LAWS.get(made.names[i].split(" ")[0], (INK,))[0] for i in pair]
    if colour[0] == colour[1]:
        colour = ["#0072B2", "#D55E00"]
    signs = LinearSegmentedColormap.from_list("signed", [colour[1], "#ffffff", colour[0]])
    mesh = axes[2].pcolormesh(across, up, 100 * difference, cmap=signs, vmin=-limit, vmax=limit, rasterized=True)
    axes[2].set_title("where the difference is")
    figure.colorbar(mesh, ax=axes[2], label=f"share of −2 ln(L ratio) (%)\n+: {names[0].split(',')[0]} has more")
    for ax in axes:
        ax.set_xlabel(labels[0])
        ax.set_ylabel(labels[1] if ax is axes[0] else "")
        if image:
            _zoom(ax, across, up, np.sum(templates, axis=0))


def _zoom(ax: Axes, across: np.ndarray, up: np.ndarray, shown: np.ndarray) -> None:
    """To what is not empty, and a little more."""
    for setter, edges, along in ((ax.set_xlim, across, shown.sum(axis=0)), (ax.set_ylim, up, shown.sum(axis=1))):
        full = np.flatnonzero(along > 0)
        if full.size:
            margin = max(2, full.size // 10)
            setter(edges[max(full[0] - margin, 0)], edges[min(full[-1] + 1 + margin, edges.size - 1)])


def _draw_lines(upper: Axes, lower: Axes, made: Templates, screen: Screen, pair: tuple[int, int], signed: np.ndarray,
                along: str | None, looks_of: tuple[list[str], list[str]]) -> None:
    """Along the scan, where `along` is None, or x or z of the only scan point."""
    if along is None:
        scale, label = _scale(made), made.axis.parameter if made.axis else ""
        x = scale.apply(made.axis.values) if made.axis else np.zeros(1)
        edges, summed = _between(x), (1, 2)
        values = [(screen.totals[i], screen.total_errors[i]) for i in pair]
        upper.set_ylabel("detected / emitted")
    else:
        place = "xz".index(along)
        scale, label = fitting_scale(screen.edges[place], "m"), along
        edges = scale.apply(screen.edges[place])
        x, summed = (edges[:-1] + edges[1:]) / 2, (0, 2 - place)
        values = [(screen.counts[i, 0].sum(axis=1 - place), np.sqrt(screen.variances[i, 0].sum(axis=1 - place)))
                  for i in pair]
        upper.set_ylabel("counts in a bin / emitted")
    for (y, errors), name, colour, marker in zip(values, looks_of[0], looks_of[1], "oD"):
        upper.errorbar(x, y, errors, color=colour, marker=marker, markersize=3.2, linewidth=1, elinewidth=0.9,
                       capsize=2, markeredgewidth=0, label=f"{name} (bars: Monte Carlo)")
    for sign, colour in zip((1, -1), looks_of[1]):
        shares = sign * np.maximum(sign * signed, 0).sum(axis=summed)
        lower.bar((edges[:-1] + edges[1:]) / 2, 100 * shares, width=np.diff(edges), color=colour, linewidth=0)
    lower.axhline(0, color=GREY, linewidth=0.8)
    lower.set_ylabel("share of\n−2 ln(L ratio) (%)")
    lower.set_xlabel(scale.label(label) if label else "")
    if made.axis is not None and along is None and made.axis.labels:
        lower.set_xticks(x, list(made.axis.labels))
    for ax in (upper, lower):
        ax.grid(axis="y")
    if along is not None:
        full = np.flatnonzero(values[0][0] + values[1][0] > 0)
        if full.size:
            margin = max(2, full.size // 10)
            upper.set_xlim(edges[max(full[0] - margin, 0)], edges[min(full[-1] + 1 + margin, edges.size - 1)])


def _draw_data(upper: Axes, made: Templates, beam: Beam, data: Observation, screen: Screen, along: str | None,
               law: int) -> None:
    """Counts, less the background, over the particles emitted; where these are not known, over the number that suits
    the first law."""
    n, models, free = against_data(made, beam, data)
    known = data.emitted if data.emitted is not None else np.full(made.points, beam.emitted or np.nan)
    if free or np.isnan(known).any():
        model = models[law].at(n)
        whole = sum(own.totals[law][data.measured].sum() for own in made.screens)
        known = np.full(made.points, model.signal.sum() / whole if whole else 1.0)
    background = (beam.backgrounds[0] * beam.seconds) if beam.seconds else 0.0
    axis = (1, 2) if along is None else 2 if along == "x" else 1
    counts = data.counts[0].sum(axis=axis)
    bins = 1 if along is None else counts.shape[1]
    emitted = known if along is None else known[:, None]
    y, errors = (counts - background / bins) / emitted, np.sqrt(np.maximum(counts, 1)) / emitted
    if along is None:
        x, y, errors = (_scale(made).apply(made.axis.values) if made.axis else np.zeros(1))[data.measured], \
            y[data.measured], errors[data.measured]
    else:
        edges = fitting_scale(screen.edges["xz".index(along)], "m").apply(screen.edges["xz".index(along)])
        x, y, errors = (edges[:-1] + edges[1:]) / 2, y[0], errors[0]
    upper.errorbar(x, y, errors, color=INK, linestyle="none", marker=".", markersize=5, elinewidth=0.9, capsize=2,
                   label="measured (bars: √counts)", zorder=5)


def _scale(made: Templates) -> Scale:
    return made.axis.scale if made.axis else Scale("")


def _between(x: np.ndarray) -> np.ndarray:
    """[n + 1] Edges around points."""
    if x.size == 1:
        return np.array([x[0] - 0.5, x[0] + 0.5])
    middle = (x[:-1] + x[1:]) / 2
    return np.concatenate([[2 * x[0] - middle[0]], middle, [2 * x[-1] - middle[-1]]])
