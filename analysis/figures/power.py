"""Power over the number of participants."""

from matplotlib.figure import Figure

from analysis.figures.style import COLOURS, legend_below, new_figure
from analysis.power import PowerCurve


def power_figure(curve: PowerCurve, wanted: float = 0.8) -> Figure:
    """Return the power and, beside it, the estimates over the runs.

    Parameters
    ----------
    curve
        What was simulated.
    wanted
        The power that is drawn as a dashed line.
    """
    figure, (left, right) = new_figure(2, simulated=True, share_y=False)
    numbers, power = list(curve.participants), [each.value for each in curve.power]
    errors = [
        [each.value - each.low for each in curve.power],
        [each.high - each.value for each in curve.power],
    ]
    left.errorbar(numbers, power, errors, fmt="o-", color=COLOURS[0], markersize=4, label="power")
    left.axhline(wanted, color="#444444", linestyle="--", linewidth=0.8, label=f"{wanted:.0%}")
    left.axhline(curve.alpha, color="#999999", linestyle=":", linewidth=0.8, label="alpha")
    left.set_ylim(0, 1.02)
    left.set_title("power")
    left.set_ylabel("share of runs that find the difference")
    right.errorbar(
        numbers,
        curve.means,
        curve.deviations,
        fmt="s",
        color=COLOURS[1],
        markersize=4,
        label="mean and standard deviation of the runs",
    )
    right.set_title(curve.quantity)
    right.set_ylabel("estimate")
    for axes in (left, right):
        axes.set_xlabel("participants")
        axes.set_xlim(0, 1.05 * max(numbers))
        legend_below(axes, columns=3)
    return figure
