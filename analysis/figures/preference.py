"""Preference of one of two in several pairs (as Lopez-Moreno 2011, figure 8.17)."""

import textwrap

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import CHANCE_COLOUR, COLOURS, new_figure
from analysis.judgements.preference import HALF, Outcome
from analysis.judgements.preference_pairs import Preferences

_OUTCOMES: dict[Outcome, tuple[str, str]] = {
    "differs": (COLOURS[1], "differs from one half"),
    "equivalent": (COLOURS[2], "equivalent within the margin"),
    "undecided": ("#B0B7BD", "undecided"),
}
_WIDTH_OF_PAIR, _WIDTH_OF_REST = 0.95, 1.4  # inches
_NARROWEST = 4.6
_CHARACTERS = 12  # of a name, before it goes on in a new line


def draw_preferences(axes: Axes, result: Preferences) -> Axes:
    """Draw a bar for each pair with its interval, against one half and the margin around it.

    Parameters
    ----------
    axes
        Where.
    result
        As from `analysis.preferences`.
    """
    margin = result.results[0].margin
    if margin is not None:
        label = f"margin ({100 * margin:g} percentage points)"
        axes.axhspan(HALF - margin, HALF + margin, color="#DDECE6", zorder=0, label=label)
    for outcome, (colour, label) in _OUTCOMES.items():
        places = [k for k, each in enumerate(result.results) if each.outcome == outcome]
        shares = [result.results[k].share for k in places]
        if not places:
            continue
        value, low, high = (
            np.array([getattr(share, name) for share in shares])
            for name in ("value", "low", "high")
        )
        axes.bar(
            places,
            value,
            width=0.6,
            yerr=(value - low, high - value),
            color=colour,
            error_kw={"elinewidth": 1.2, "ecolor": "#222222"},
            label=label,
        )
    axes.axhline(HALF, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1, label="one half")
    names = [
        "\n".join(line for part in cell for line in textwrap.wrap(str(part), _CHARACTERS))
        for cell in _told(result).itertuples(index=False)
    ]
    axes.set_xticks(range(len(names)), names)
    axes.set_ylim(0, 1)
    shares_shown = np.linspace(0, 1, 5)
    axes.set_yticks(shares_shown, [f"{100 * share:.0f} %" for share in shares_shown])
    axes.grid(visible=False, axis="x")
    axes.set_ylabel("share of answers, 95 % interval")
    return axes


def preferences_figure(result: Preferences, *, simulated: bool) -> Figure:
    """Return the preference in each pair.

    Parameters
    ----------
    result
        As from `analysis.preferences`.
    simulated
        Whether programs answered; then the figure says so.
    """
    cells = _told(result)
    width = max(_NARROWEST, _WIDTH_OF_REST + _WIDTH_OF_PAIR * len(result.results))
    figure, (axes,) = new_figure(1, simulated, width=width, height=3.4)
    draw_preferences(axes, result)
    names = {each.names for each in result.results}
    title = "{} preferred to {}".format(*names.pop()) if len(names) == 1 else "Pairs of items"
    axes.set_title(title, loc="left")
    axes.set_xlabel(", ".join(str(name).replace("_", " ") for name in cells.columns))
    # Names of pairs may take several lines: only the layout knows where they end.
    figure.legend(loc="outside lower center", ncols=2)
    return figure


def _told(result: Preferences) -> pd.DataFrame:
    """Return what makes the cells; of one pair of items only what else makes them."""
    cells = result.cells
    if "pair" in cells and len(cells.columns) > 1 and len(set(cells["pair"])) == 1:
        return cells.drop(columns="pair")
    return cells
