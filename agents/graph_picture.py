"""The picture of a transfer graph: its maps and edges, the spectrum of its Laplacian, and where transfer hurt."""

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from agents.laplacian import laplacian, relabel
from antgym.errors import MissingExtraError

if TYPE_CHECKING:
    from agents.graph import TransferGraph

Floats = NDArray[np.float64]
FAINTEST = 0.02  # affinity below which an edge is not drawn


def draw(graph: "TransferGraph", path: Path) -> Path:
    """Write a PNG of three panels and return its path.

    Vertices are the source maps, on a circle in the order of the Fiedler vector, so that what hangs together lies
    together; their colour is the set that does best on them, an edge is as strong as the affinity. Beside them the
    eigenvalues of the Laplacian, and the fresh cost of what the others hand over to each map when it is left out.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    figure = Figure(figsize=(15, 5), layout="constrained")
    maps, spectrum, left_out = figure.subplots(1, 3, width_ratios=(5, 4, 5))
    _draw_maps(maps, graph)
    _draw_spectrum(spectrum, graph)
    _draw_left_out(left_out, graph)
    figure.suptitle(f"transfer graph of {len(graph.names)} maps, {graph.evaluations:,} evaluations")
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120)
    path.write_bytes(buffer.getvalue())
    return path


def circle(affinity: Floats) -> Floats:
    """Return the (n, 2) places of n vertices on the unit circle, ordered by the Fiedler vector."""
    n = len(affinity)
    _, vectors = np.linalg.eigh(laplacian(affinity))
    turns = np.empty(n)
    turns[np.argsort(vectors[:, min(1, n - 1)], kind="stable")] = np.arange(n) / n
    return np.stack([np.cos(2 * np.pi * turns), np.sin(2 * np.pi * turns)], axis=1)


def _draw_maps(axes: Any, graph: "TransferGraph") -> None:
    edges = graph.affinities
    places, labels = circle(edges), relabel(graph.judged)
    for i, j in zip(*np.triu_indices(len(edges), 1), strict=True):
        if edges[i, j] > FAINTEST:
            axes.plot(
                *places[[i, j]].T, color="0.3", alpha=float(edges[i, j]), linewidth=0.5 + 2 * edges[i, j]
            )
    shades = np.unique(labels, return_inverse=True)[1]
    axes.scatter(*places.T, c=shades, cmap="tab20", s=120, zorder=2)
    for (x, y), name, label in zip(places, graph.names, labels, strict=True):
        align = {"ha": "left" if x > 0 else "right", "va": "center", "fontsize": 7}
        axes.text(1.12 * x, 1.12 * y, f"{_short(name)}\nset {label + 1}", **align)
    axes.set(
        xlim=(-1.9, 1.9), ylim=(-1.3, 1.3), title=f"affinity exp(-regret / {graph.tau:g}), best set by colour"
    )
    axes.set_aspect("equal")
    axes.axis("off")


def _draw_spectrum(axes: Any, graph: "TransferGraph") -> None:
    values = graph.spectrum
    axes.stem(np.arange(1, len(values) + 1), values)
    axes.set(xlabel="eigenvalue", ylabel="λ", title="spectrum of the Laplacian", xlim=(0, len(values) + 1))


def _draw_left_out(axes: Any, graph: "TransferGraph") -> None:
    rows = graph.negative_transfer
    axes.set_title("each map left out: what the others hand over")
    if not rows:
        axes.text(0.5, 0.5, "not run", ha="center", transform=axes.transAxes)
        return
    places = np.arange(len(rows))
    kinds = (("transferred", "crimson", "o"), ("copied", "black", "_"), ("default", "0.6", "x"))
    for kind, colour, marker in kinds:
        axes.scatter([getattr(row, kind) for row in rows], places, color=colour, marker=marker, label=kind)
    hurt = [i for i, row in enumerate(rows) if row.worse_than_copy or row.worse_than_default]
    axes.scatter(
        [rows[i].transferred for i in hurt],
        hurt,
        s=150,
        facecolors="none",
        edgecolors="crimson",
        label="negative",
    )
    axes.set_yticks(places, [_short(row.name) for row in rows], fontsize=7)
    axes.set_xlabel("fresh cost in straight lines")
    axes.legend(fontsize=8)


def _short(name: str) -> str:
    """Return a suite's item without its suite."""
    return name.split("/", 1)[-1]
