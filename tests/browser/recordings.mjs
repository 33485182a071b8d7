// Recordings of others as data sets: a harbour seen by radar and lidar, and a video.

import { readFile } from "node:fs/promises";
import { finished, uploaded } from "./support.mjs";

const RECORDING = new URL("../../examples/data/autoferry-scenario2/", import.meta.url);

/** A data set as the input of a job. */
export const dataset = ({ id }, more = {}) => ({ source: "dataset", dataset_id: id, ...more });

/** A recording whose clock counts seconds since 1970. */
export async function recorded() {
  const read = async (file, kind) =>
    uploaded(file, await readFile(new URL(file, RECORDING)), { format: "autoferry", kind });
  const [detections, truth] = [
    await read("detections.json", "detections"),
    await read("groundTruth.json", "truth"),
  ];
  const body = JSON.parse(
    await readFile(new URL("../../examples/autoferry-scenario2.json", import.meta.url)),
  );
  delete body.kind;
  Object.assign(body, {
    input: dataset(detections, { sensor_ids: ["radar"] }),
    truth: dataset(truth),
  });
  return { ...(await finished("evaluate", body)), detections, truth };
}

/**
 * Two targets and three tracks of boxes: track 12 takes over from track 11, track 13 is somewhere
 * else.
 */
export async function filmed() {
  const line = (frame, id, left) => `${frame},${id},${left},10,20,40,1,-1,-1,-1`;
  const frames = [1, 2, 3, 4, 5, 6];
  const truth = frames
    .flatMap((frame) => [line(frame, 1, 10 + frame), line(frame, 2, 300 + frame)])
    .join("\n");
  const tracks = frames
    .flatMap((frame) => [line(frame, frame < 4 ? 11 : 12, 10 + frame), line(frame, 13, 600)])
    .join("\n");
  const of = (name, text, kind) => uploaded(name, text, { format: "mot", kind });
  const sets = [await of("gt.txt", truth, "truth"), await of("test.txt", tracks, "tracks")];
  return finished("evaluate", {
    name: "browser video",
    profile: "vision",
    truth: dataset(sets[0]),
    tracks: dataset(sets[1]),
  });
}
