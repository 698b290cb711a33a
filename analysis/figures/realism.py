"""How often images are judged real, and how well they are told from photographs."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import CHANCE_COLOUR, draw_rows, new_figure
from analysis.judgements.realism import PHOTOGRAPH, PROCESSED, UNTOLD, Realism

_LABELS = {PHOTOGRAPH: "photographs", PROCESSED: "processed images", UNTOLD: "images"}
_HEIGHT_OF_ROW, _HEIGHT_OF_REST = 0.3, 1.35  # inches


def draw_shares(axes: Axes, result: Realism) -> Axes:
    """Draw the share judged real of each condition and kind of image, with its interval.

    Parameters
    ----------
    axes
        Where; rows from top to bottom.
    result
        As from `analysis.realism`.
    """
    names = _names(result.table, result.by)
    for number, (kind, label) in enumerate(_LABELS.items()):
        rows = np.flatnonzero(result.table["kind"] == kind)
        if not len(rows):
            continue
        draw_rows(axes, result.table.iloc[rows], ("share", "low", "high"), rows, number, label)
    axes.axvline(0.5, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlim(0, 1)
    shares_shown = np.linspace(0, 1, 5)
    axes.set_xticks(shares_shown, [f"{100 * share:.0f} %" for share in shares_shown])
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("judged real")
    return axes


def draw_sensitivities(axes: Axes, result: Realism) -> Axes:
    """Draw d' of each condition with its interval over participants; 0 is "not told apart"."""
    table = result.sensitivity_frame()
    rows = np.arange(len(table))
    draw_rows(axes, table, ("d_prime", "d_prime_low", "d_prime_high"), rows, 2, None)
    axes.axvline(0, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1)
    axes.set_yticks(rows, _names(table, result.by))
    axes.set_ylim(len(table) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("d' (0: not told from photographs)")
    return axes


def realism_figure(result: Realism, *, simulated: bool) -> Figure:
    """Return shares judged real and, where there are photographs, sensitivities.

    Parameters
    ----------
    result
        As from `analysis.realism`.
    simulated
        Whether programs answered; then the figure says so.
    """
    panels = 2 if result.sensitivities else 1
    height = _HEIGHT_OF_REST + _HEIGHT_OF_ROW * len(result.table)
    figure, axes = new_figure(panels, simulated, width=4.3 * panels, height=height, share_y=False)
    draw_shares(axes[0], result).set_title("Share of answers", loc="left")
    if panels == 2:
        draw_sensitivities(axes[1], result)
        axes[1].set_title("Told from photographs", loc="left")
    if len(set(result.table["kind"])) > 1:
        figure.legend(loc="outside lower center", ncols=len(_LABELS))
    return figure


def _names(table: pd.DataFrame, by: tuple[str, ...]) -> list[str]:
    return [", ".join(map(str, cell)) for cell in table[list(by)].itertuples(index=False)]
