"""Time of CLEAR + Identity + HOTA on the same boxes: trackloom's figures come on standard input, motrics and TrackEval run."""

import contextlib
import io
import sys
import time

import motrics
import numpy as np

with contextlib.redirect_stdout(io.StringIO()):
    import trackeval

SECONDS_EACH = 1.0
FEWEST_RUNS = 5


def rows_of(path, is_truth):
    """Frame, object and box of each row; truth without confidence does not count."""
    with open(path) as file:
        rows = [[float(cell) for cell in line.split(",")] for line in file if line.strip()]
    return [row[:6] for row in rows if not (is_truth and row[6] == 0)]


def repeated(rows, copies, frames):
    """Objects (from 0) and boxes of each frame, the copies one after the other with fresh objects."""
    objects = sorted({row[1] for row in rows})
    number = {name: index for index, name in enumerate(objects)}
    ids = [[] for _ in range(copies * frames)]
    boxes = [[] for _ in range(copies * frames)]
    for copy in range(copies):
        for frame, name, *box in sorted(rows):
            place = copy * frames + int(frame) - 1
            ids[place].append(number[name] + copy * len(objects))
            boxes[place].append(box)
    return ids, [np.array(box, dtype=float).reshape(-1, 4) for box in boxes]


def best_time(run, seconds=SECONDS_EACH, fewest=FEWEST_RUNS):
    times = []
    start = time.perf_counter()
    while len(times) < fewest or time.perf_counter() - start < seconds:
        before = time.perf_counter()
        result = run()
        times.append(time.perf_counter() - before)
    return min(times), result


def overlaps(truth, tracks):
    """Intersection over union of all with all."""
    low = np.maximum(truth[:, None, :2], tracks[None, :, :2])
    high = np.minimum((truth[:, :2] + truth[:, 2:])[:, None], (tracks[:, :2] + tracks[:, 2:])[None])
    shared = np.clip(high - low, 0, None).prod(axis=2)
    return shared / (truth[:, 2:].prod(axis=1)[:, None] + tracks[:, 2:].prod(axis=1)[None] - shared)


def trackeval_run(truth, tracks):
    (truth_ids, truth_boxes), (track_ids, track_boxes) = truth, tracks
    data = {
        "num_timesteps": len(truth_ids),
        "num_gt_ids": len({name for ids in truth_ids for name in ids}),
        "num_tracker_ids": len({name for ids in track_ids for name in ids}),
        "num_gt_dets": sum(map(len, truth_ids)),
        "num_tracker_dets": sum(map(len, track_ids)),
        "gt_ids": [np.array(ids, dtype=int) for ids in truth_ids],
        "tracker_ids": [np.array(ids, dtype=int) for ids in track_ids],
        "similarity_scores": [overlaps(a, b) for a, b in zip(truth_boxes, track_boxes)],
    }
    with contextlib.redirect_stdout(io.StringIO()):
        metrics = [trackeval.metrics.CLEAR(), trackeval.metrics.Identity(), trackeval.metrics.HOTA()]
    return lambda: [metric.eval_sequence(data) for metric in metrics]


def main():
    folder = sys.argv[1]
    ours = {}
    for line in sys.stdin:
        cells = line.split()
        if cells and cells[0].isdigit():
            ours[int(cells[0])] = float(cells[-1])
    truth_rows, track_rows = rows_of(f"{folder}/gt.txt", True), rows_of(f"{folder}/test.txt", False)
    frames = int(max(row[0] for row in truth_rows + track_rows))
    print("copies  trackloom ms  motrics ms  ratio  TrackEval ms  ratio      (best of several runs; TrackEval without overlaps)")
    for copies in map(int, sys.argv[2:]):
        truth, tracks = repeated(truth_rows, copies, frames), repeated(track_rows, copies, frames)
        frames_of = [motrics.Frames(ids=ids, boxes=boxes) for ids, boxes in (truth, tracks)]
        motrics_s, result = best_time(lambda: motrics.evaluate(*frames_of, box_format="xywh"))
        slow = copies > 10
        trackeval_s, reference = best_time(trackeval_run(truth, tracks), fewest=1 if slow else FEWEST_RUNS)
        assert abs(result.hota.hota - reference[2]["HOTA"].mean()) < 1e-9, "the peers disagree: not the same boxes"
        mine = ours[copies]
        print(
            f"{copies:6}  {mine:12.4f}  {motrics_s * 1e3:10.4f}  {motrics_s * 1e3 / mine:5.1f}"
            f"  {trackeval_s * 1e3:12.2f}  {trackeval_s * 1e3 / mine:7.0f}",
            flush=True,
        )


main()
