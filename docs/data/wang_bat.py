"""The numbers of Wang, Li, Huang in docs/papers.md, one a row."""

import math
import statistics

from campaign import Campaign

# Outcomes that the page uses, of each preset: with the difference to what the cell is compared with, where that is used.
KEPT = {
    "wang-bat-tables": {"identity": True, "stay": False, "error_deg": True, "error_kept_deg": False, "optimum_reached": False},
    "wang-bat-noise": {"identity": True, "stay": False, "error_deg": True},
    "wang-bat-clutter": {"identity": True, "error_deg": False},
    "wang-bat-targets": {"identity": True, "error_deg": False},
    "wang-bat-crossings": {"identity": True, "error_deg": False},
    "wang-bat-objective": {name: False for objective in ("sum", "ratio") for group in ("all", "detected", "shared")
                           for name in (f"{objective}, {group}", f"{objective}, {group}, lack")},
    "wang-bat-alpha-gamma": {"identity": True, "error_deg": True, "optimum_reached": True},
    "wang-bat-sea-trials": {"identity": False, "stay": False, "targets kept": False, "error_deg": False, "p_d": False},
}
# Contenders whose difference to the bats is taken run by run, and of what.
AGAINST_BATS = {"NN, shared": ["identity", "error_deg"], "PDA": ["identity", "error_deg"]}
BATS = "BADA, sum"
TIMED = "wang-bat-tables"
# Of the normal distribution: the fewest pairs are 100.
Z_97_5 = 1.96


def campaign_rows(folder):
    for preset, kept in KEPT.items():
        of = Campaign.of(folder, preset)
        for cell in of.cells:
            yield from of.outcomes(cell, kept)
        yield from against_bats(of)
        if preset == TIMED:
            yield from of.time_ratios()


def against_bats(of):
    runs = of.runs()
    for cell, of_cell in runs.items():
        for name, outcomes in AGAINST_BATS.items():
            bats = runs.get(cell.removesuffix(name) + BATS, [])
            if not cell.endswith(name) or not bats:
                continue
            for outcome in outcomes:
                pairs = [one[outcome] - other[outcome] for one, other in zip(of_cell, bats)]
                mean, half = statistics.mean(pairs), Z_97_5 * statistics.stdev(pairs) / math.sqrt(len(pairs))
                yield of.row(cell, f"{outcome}, less {BATS}", mean, (mean - half, mean + half), len(pairs))
