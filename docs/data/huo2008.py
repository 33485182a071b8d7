"""The numbers of Huo et al. in docs/papers.md, one a row: means and intervals of the campaigns, and what is counted run by run."""

import math
import statistics

import huo2008_plain
from campaign import Campaign, ends, mean

# Outcomes that the page uses, and whether their difference to the cell that a cell is compared with is used, too.
KEPT = {
    "huo2008-study": {"tuples right": True, "gap": False},
    "huo2008-statistic": {"tuples right": False, "precision": False, "recall": False},
    "huo2008-printed": {"tuples right": True},
    "huo2008-confirmation": {"true tuples": True},
    "huo2008-integer-programming": {"tuples right": False},
    "huo2008-nodes": {"tuples right": True, "gap": False},
    "huo2008-relaxation": {"tuples right": True, "J": True},
    "huo2008-alpha": {},
}
# Of the many correlators of the study those that the page speaks of.
STUDIED = ("nearest", "weighted", "genetic", "exact", "the paper's coding")
TIMED = ["huo2008-printed", "huo2008-integer-programming", "huo2008-relaxation"]


def campaign_rows(folder):
    for preset, kept in KEPT.items():
        of = Campaign.of(folder, preset)
        runs = of.runs()
        for cell in of.cells:
            if preset == "huo2008-study" and not cell["name"].endswith(STUDIED):
                continue
            yield from of.outcomes(cell, kept)
            yield from counted(of, cell, runs)
        if preset in TIMED:
            yield from of.time_ratios()


def plain_rows():
    """Of the plain program, which takes minutes."""
    plain = Campaign("huo2008-printed", 1)
    return shares_and_gaps(plain, "3 × 10, plain program", huo2008_plain.gaps())


def counted(of, cell, runs_of):
    """What no outcome of a campaign is: counted, or reckoned run by run."""
    name, runs = cell["name"], runs_of[cell["name"]]
    if of.preset == "huo2008-printed":
        yield from shares_and_gaps(of, name, [run["gap"] for run in runs])
    elif of.preset == "huo2008-integer-programming":
        yield of.row(name, "share proven", *share(sum(run.get("gap") == 0 for run in runs), len(runs)))
    elif of.preset == "huo2008-confirmation":
        yield of.row(name, "false tuples", *mean(false_tuples(runs)))
        other = cell.get("compared_with")
        if other and other != name:
            pairs = zip(false_tuples(runs), false_tuples(runs_of[other]))
            yield of.row(name, f"false tuples, less {other}", *mean([one - two for one, two in pairs]))
    elif of.preset == "huo2008-alpha":
        found = cell["outcomes"]["recall"]
        low, high = ends(found["interval"])
        yield of.row(name, "true pairs rejected", 1 - found["mean"], (1 - high, 1 - low), found["count"])


def shares_and_gaps(of, name, gaps):
    yield of.row(name, "share at the optimum", *share(sum(gap == 0 for gap in gaps), len(gaps)))
    yield of.row(name, "J above the optimum", *mean(gaps))


def false_tuples(runs):
    return [run["tuples"] - run["true tuples"] for run in runs]


def share(successes, count):
    """Share, Wilson's interval and count."""
    z = statistics.NormalDist().inv_cdf(0.975)
    p, grown = successes / count, 1 + z * z / count
    half = z * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count)) / grown
    centre = (p + z * z / (2 * count)) / grown
    return p, (max(0.0, centre - half), min(1.0, centre + half)), count
