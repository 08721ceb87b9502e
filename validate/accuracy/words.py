"""Tables, sentences and pictures of the page: every figure in a sentence is formed here together with its claim."""
import numpy as np

import study

COLOURS = {"safety": "#1f77b4", "precision": "#17becf", "velocity": "#d62728", "damping": "#9467bd", "form of damping": "#8c564b",
           "gap": "#bcbd22", "round-off": "#7f7f7f", "particles": "#2ca02c", "seeds": "#98df8a", "elements": "#ff7f0e",
           "mass scaling": "#e377c2", "start": "#000000"}
MARKS = "os^Dv<>P*"


def table(head, rows):
    return study.table(head, rows)


def percent(value, digits=2):
    return "-" if not np.isfinite(value) else f"{100 * value:.{digits}g} %"


def signed(value):
    return "-" if not np.isfinite(value) else "0" if abs(value) < 1e-12 else f"{100 * value:+.2g} %"


def figure(value, digits=4):
    return "-" if not np.isfinite(value) else f"{value:.{digits}g}"


def seconds(value):
    return "-" if not np.isfinite(value) else f"{value:.2g}" if value < 100 else f"{value:.0f}"


def plain(value):
    if isinstance(value, tuple):
        return ", ".join(map(plain, value))
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)


def trend(slope, error, what):
    """Words on whether a slope differs from zero, by its own standard error."""
    if not np.isfinite(error):
        return f"{what}: {signed(slope)}"
    if abs(slope) < 2 * error:
        return f"no trend in {what} ({signed(slope)} +- {percent(error)} over the range)"
    return f"{what}: {signed(slope)} +- {percent(error)} over the range"


def against(value, error, claims):
    """The first of claims (number, words) that the value agrees with to two standard errors; else None."""
    for number, words in claims:
        if abs(value - number) <= 2 * error:
            return words
    return None


class Pictures:
    def __init__(self, folder, link):
        self.folder, self.link = folder, link

    @staticmethod
    def plt():
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        plt.rcParams.update({"font.size": 8, "axes.grid": True, "grid.alpha": 0.3, "lines.linewidth": 1.1})
        return plt

    @staticmethod
    def seconds_axis(axes):
        """Formats seconds as plain numbers; ticks between decades only if the axis has a single decade."""
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        low, high = axes.get_xlim()
        axes.set_xlabel("CPU seconds of one thread")
        if axes.get_xscale() != "log":
            return
        narrow = high < 20 * low
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if narrow else (1,)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())

    def save(self, drawn, name, words):
        self.folder.mkdir(parents=True, exist_ok=True)
        drawn.tight_layout()
        drawn.savefig(self.folder / f"accuracy-{name}.png", dpi=100, metadata={"Software": None})
        self.plt().close(drawn)
        return f"![{words}]({self.link}/accuracy-{name}.png)"
