# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of the pictures of a run: colours, titles, panels on a sheet."""
import run_data  # first: it says so if one of the next is missing
from run_data import Units, label
import matplotlib.pyplot as plt
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

SAND, EARTH, INK = "#e3c48d", "#8a5a22", "#222222"
BLUE, RED, GREEN, GREY = "#24639c", "#b5382b", "#3d7d3a", "#777777"
TRACERS = [RED, BLUE, GREEN, "#8e4fa8", "#d98200", "#0f8f8f", "#c2418c",
           "#4a4a4a"]
GRAINS = LinearSegmentedColormap.from_list("grains", ["#f7f9fb", SAND])

plt.rcParams.update({
    "figure.dpi": 110,
    "savefig.dpi": 150,
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
})


class Sheet:
    """Panels of one shape in rows and columns, laid out in inches, each with
    room for a colour bar if `bars` and for titles of `lines` lines, at least
    `least` wide however narrow the panels are. Above them stand the title of
    the run, what `note` says, and a legend of `handles`."""

    def __init__(self, run, count, columns, aspect, bars, note="", handles=(),
                 lines=1, least=2.3, width=9.6):
        rows = -(-count // columns)
        foot, left, gap = 0.5, 0.78, 0.2 + 0.16 * lines
        right = 0.75 if bars else 0.25
        w = width / columns - left - right
        h = min(max(w / aspect, 0.5), 6.0)
        w = min(w, h * aspect) if h == 6.0 else w
        step = h + gap + (0.12 if columns == 1 else 0.15)
        pitch = max(left + w + right, least)
        wide = max(columns * pitch, 4.8)
        title = run.title(wide) + ([note] if note else [])
        entries = max(1, int(wide / 1.9))  # of the legend in a row
        head = 0.1 + 0.21 * len(title) + 0.22 * -(-len(handles) // entries)
        total = wide, head + rows * step + foot - 0.1
        self.fig = plt.figure(figsize=total)
        self._head(title, handles, entries)
        self.columns = columns
        self.axes, self.bars = [], []
        for k in range(count):
            x = (left + (k % columns) * pitch
                 + 0.5 * (total[0] - columns * pitch))
            y = total[1] - head - (k // columns + 1) * step + 0.1
            self.axes.append(self._add(x, y, w, h))
            if bars:
                self.bars.append(self._add(x + w + 0.08, y, 0.12, h))

    def _add(self, x, y, w, h):
        full = self.fig.get_size_inches()
        return self.fig.add_axes([x / full[0], y / full[1], w / full[0],
                                  h / full[1]])

    def name_axes(self, units, upwards="height"):
        """Numbers at every panel, names at the outer ones only."""
        for k, ax in enumerate(self.axes):
            ax.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
            if k % self.columns == 0:
                ax.set_ylabel(label(upwards, units.length))
            if k + self.columns >= len(self.axes):
                ax.set_xlabel(label(units.across, units.length), labelpad=2)
            else:
                ax.tick_params(labelbottom=False)

    def _head(self, title, handles, entries):
        wide, high = self.fig.get_size_inches()
        for k, line in enumerate(title):
            text = self.fig.text(0.5, 1 - (0.08 + 0.21 * k) / high, line,
                                 ha="center", va="top", fontsize=11)
            width = text.get_window_extent().width / self.fig.dpi
            text.set_fontsize(11 * min(1, (wide - 0.2) / width))
        if handles:
            self.fig.legend(
                handles=handles, ncol=min(entries, len(handles)), fontsize=9,
                loc="upper center", borderaxespad=0, columnspacing=1.5,
                bbox_to_anchor=(0.5, 1 - (0.1 + 0.21 * len(title)) / high))


class RunWords:
    """What the pictures of a run say of it: its title, units, colours."""

    def __init__(self, parameters, directory):
        self.parameters, self.directory = parameters, directory
        self.units = Units(parameters)
        self.solid = parameters.get("dimension") == "3"

    def title(self, width):
        """The title in lines that fit into so many inches."""
        return run_data.title_lines(self.parameters, self.directory,
                                    int(12.5 * width))

    def colour(self, tracer):
        """The colour of a tracer, the same in all pictures."""
        names = [k[8:] for k in self.parameters if k.startswith("tracers.")]
        place = names.index(tracer) if tracer in names else 0
        return TRACERS[place % len(TRACERS)]


def line(colour, name, style="-"):
    """An entry of a legend."""
    return Line2D([], [], color=colour, label=name, ls=style, lw=1.4)
