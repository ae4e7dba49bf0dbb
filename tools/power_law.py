# SPDX-License-Identifier: GPL-3.0-or-later
"""Power laws y = C x^n through points, over one range of x or two."""
import numpy as np

FEWEST_TO_SEARCH = 5  # points with which a break can be found


class PowerLaw:
    """y = C x^n by least squares of the logarithms, with the standard error
    sqrt(sum r^2/(k - 2)/sum (ln x - mean)^2) of n from the residuals r of k
    points; None of two, which a line always meets."""

    def __init__(self, x, y):
        u, v = np.log(x), np.log(y)
        spread = np.sum((u - u.mean()) ** 2)
        self.low, self.high, self.count = x.min(), x.max(), len(x)
        self.exponent = float(np.sum((u - u.mean()) * v) / spread)
        self.factor = float(np.exp(v.mean() - self.exponent * u.mean()))
        rest = v - np.log(self.factor) - self.exponent * u
        self.misfit = float(np.sum(rest ** 2))
        self.error = (float(np.sqrt(self.misfit / (len(x) - 2) / spread))
                      if len(x) > 2 else None)

    def at(self, x):
        return self.factor * x ** self.exponent


def fit_one(x, y):
    """The law through all points with x, y > 0; None if they are at fewer than
    two places."""
    keep = (x > 0) & (y > 0)
    x, y = x[keep], y[keep]
    return PowerLaw(x, y) if len(np.unique(x)) > 1 else None


def fit_two(x, y, place):
    """[law below, law above] a break at `place`, to which a point just there
    belongs on both sides; either may be None."""
    return [fit_one(x[x <= place], y[x <= place]),
            fit_one(x[x >= place], y[x >= place])]


def crossing(below, above):
    """Where two laws meet if that is in the gap between them, else the middle
    of the gap."""
    slope = below.exponent - above.exponent
    if slope != 0:
        place = np.exp(np.log(above.factor / below.factor) / slope)
        if below.high <= place <= above.low:
            return float(place)
    return float(np.sqrt(below.high * above.low))


def find_break(x, y):
    """The place of the break, outside of all points, at which two laws leave
    the least sum of squares, each of two points or more. None if there are
    fewer than FEWEST_TO_SEARCH."""
    keep = (x > 0) & (y > 0)
    x, y = x[keep], y[keep]
    places = np.unique(x)
    if len(places) < FEWEST_TO_SEARCH:
        return None
    trials = []
    for k in range(2, len(places) - 1):
        low = x < places[k]
        below, above = PowerLaw(x[low], y[low]), PowerLaw(x[~low], y[~low])
        trials.append((below.misfit + above.misfit, crossing(below, above)))
    return min(trials)[1]
