"""The numbers of the campaigns of Cai et al. and of the genetic c-means page in docs/papers.md, one a row."""

from campaign import Campaign, ends

# Outcomes that the page uses, of each preset: with the difference to what the cell is compared with, where that is used.
KEPT = {
    "cai-fuzzy-tables": {"accuracy": True, "iterations": False},
    "cai-fuzzy-duplicates": {"accuracy": True, "iterations": False},
    "cai-fuzzy-starts": {"accuracy": True, "iterations": False, "J": True, "unconverged": False},
    "cai-fuzzy-noise": {"accuracy": True},
    "cai-fuzzy-strongest": {"IDF1": True},
    "cai-fuzzy-attributes": {"accuracy": True},
    "cai-fuzzy-genetic": {"accuracy": True, "iterations": False, "J": True},
}

CLUSTERS = 25


def campaign_rows(folder):
    for preset, kept in KEPT.items():
        of = Campaign.of(folder, preset)
        for cell in of.cells:
            yield from of.outcomes(cell, kept)
            if preset == "cai-fuzzy-duplicates":
                yield distances(of, cell)


def distances(of, cell):
    """Distances computed at one instant: of all reports to all clusters, once, and again in every iteration."""
    found = cell["outcomes"]
    pairs = CLUSTERS * found["reports"]["mean"] / found["instants"]["mean"]
    iterations, quantity = found["iterations"], "distances an instant"
    if iterations["mean"] is None:
        return of.row(cell["name"], quantity, pairs, None, cell["runs"])
    interval = tuple(pairs * (1 + end) for end in ends(iterations["interval"]))
    return of.row(cell["name"], quantity, pairs * (1 + iterations["mean"]), interval, cell["runs"])
