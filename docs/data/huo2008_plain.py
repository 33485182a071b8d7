"""A plain program of the genetic algorithm as Huo et al. 2008 print it, to hold the service's against.

    python3 docs/data/huo2008_plain.py

It shares nothing with the service but the problems: huo2008-problems.csv has, of the first 15 runs of `huo2008-printed` at 3 × 10, the
sum λ over the common times of every pair of tracks of neighbouring sensors. A chromosome is M − 1 strings of T places; J is the sum of b.
100 individuals, 500 generations, P_c 0.8, P_m 0.3, half of a generation new (P_r 0.5), the two best kept, selection by rank.
"""

import csv
import random
from pathlib import Path

PROBLEMS = Path(__file__).with_name("huo2008-problems.csv")
POPULATION, GENERATIONS, CROSSOVER, MUTATION, NEW, ELITE = 100, 500, 0.8, 0.3, 50, 2


def problems():
    """Of each problem, for every two neighbouring sensors, the table of λ."""
    found = {}
    with open(PROBLEMS, newline="") as file:
        for row in csv.DictReader(file):
            tables = found.setdefault(int(row["problem"]), {})
            values = [float(row[name]) for name in row if name.startswith("lambda_")]
            tables.setdefault(int(row["sensor"]), []).append(values)
    return [[tables[sensor] for sensor in sorted(tables)] for _, tables in sorted(found.items())]


def cost(tables, strings):
    total = 0.0
    for target in range(len(tables[0])):
        before = target
        for table, string in zip(tables, strings):
            total += table[before][string[target]]
            before = string[target]
    return total


def least(tables):
    """b adds neighbours only: the optimum is one assignment a table, here by all sets of columns taken."""
    return sum(assignment(table) for table in tables)


def assignment(table):
    costs = {0: 0.0}
    for row in table:
        grown = {}
        for taken, so_far in costs.items():
            for column, value in enumerate(row):
                if not taken >> column & 1:
                    key = taken | 1 << column
                    grown[key] = min(grown.get(key, float("inf")), so_far + value)
        costs = grown
    return min(costs.values())


def partially_matched(one, other, draw):
    """PMX: both children get the other's stretch; what that would have twice takes the place of what it replaced."""
    first, last = sorted((draw.randint(0, len(one)), draw.randint(0, len(one))))
    children = []
    for own, given in ((one, other), (other, one)):
        instead = dict(zip(given[first:last], own[first:last]))
        child = list(given[first:last])
        outside = []
        for value in own[:first] + own[last:]:
            while value in instead:
                value = instead[value]
            outside.append(value)
        children.append(outside[:first] + child + outside[first:])
    return children


def by_rank(members, draw):
    """The chance of a place falls linearly from the best to the worst."""
    weights = range(2 * len(members) - 1, 0, -2)
    return draw.choices(members, weights)[0]


def child_of(members, tables, draw):
    left, right = by_rank(members, draw)[1], by_rank(members, draw)[1]
    pair = [list(map(list, left)), list(map(list, right))]
    if draw.random() < CROSSOVER:
        crossed = [partially_matched(a, b, draw) for a, b in zip(left, right)]
        pair = [[two[side] for two in crossed] for side in (0, 1)]
    for strings in pair:
        if draw.random() < MUTATION:
            string = draw.choice(strings)
            a, b = draw.randrange(len(string)), draw.randrange(len(string))
            string[a], string[b] = string[b], string[a]
    return [(cost(tables, strings), strings) for strings in pair]


def search(tables, draw):
    """The least J of the last generation."""
    targets = len(tables[0])
    members = []
    for _ in range(POPULATION):
        strings = [draw.sample(range(targets), targets) for _ in tables]
        members.append((cost(tables, strings), strings))
    for _ in range(GENERATIONS):
        members.sort(key=lambda member: member[0])
        kept = members[:ELITE] + [by_rank(members, draw) for _ in range(POPULATION - NEW - ELITE)]
        while len(kept) < POPULATION:
            kept += child_of(members, tables, draw)
        members = kept[:POPULATION]
    return min(members)[0]


def gaps():
    """How far J ends above the optimum, as a share of it, in each problem."""
    draw = random.Random(1)
    found = []
    for tables in problems():
        optimum = least(tables)
        gap = search(tables, draw) / optimum - 1
        found.append(0.0 if gap < 1e-9 else gap)
    return found


if __name__ == "__main__":
    found = gaps()
    print(f"optimum in {sum(gap == 0 for gap in found)} of {len(found)}; J above it by {sum(found) / len(found):.1%}")
    print(", ".join(f"{gap:.3f}" for gap in found))
