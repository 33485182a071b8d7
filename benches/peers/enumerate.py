#!/usr/bin/env python3
"""JPDA as the papers write it, listing every joint event of a cluster: how many there are and how long it takes.

cargo run --release --no-default-features --example jpda_clusters -- "in line" | python3 benches/peers/enumerate.py

Each line of the input is a cluster: for each track its detections with the ratio of their weights to that of none.
"""

import json
import sys
import time


def marginals(cluster):
    """The sums over the joint events in which each track has each detection, and over all of them."""
    sums = [[0.0] * (len(track) + 1) for track in cluster]
    used, chosen, events = set(), [], 0

    def visit(track, weight):
        nonlocal events
        if track == len(cluster):
            events += 1
            for place, choice in enumerate(chosen):
                sums[place][choice] += weight
            return
        chosen.append(len(cluster[track]))
        visit(track + 1, weight)
        for choice, (detection, ratio) in enumerate(cluster[track]):
            if detection not in used:
                used.add(detection)
                chosen[track] = choice
                visit(track + 1, weight * ratio)
                used.discard(detection)
        chosen.pop()

    visit(0, 1.0)
    return sums, events


def main():
    clusters = [json.loads(line) for line in sys.stdin]
    start, events, largest = time.process_time(), 0, 0
    for cluster in clusters:
        found = marginals(cluster)[1]
        events, largest = events + found, max(largest, found)
    seconds = time.process_time() - start
    print(f"{len(clusters)} clusters, {events} joint events, {largest} in the largest; {seconds:.1f} s")


if __name__ == "__main__":
    main()
