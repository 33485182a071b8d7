// The clock of a job's pictures: an index into the times of its scans. The address keeps the time;
// without one the clock stands at the end, so that everything is shown.

import { computed, effect, type ReadonlySignal, type Signal, signal } from "@preact/signals";
import { originOf } from "../times";
import { params, setParams } from "./url";

export interface Clock {
  times: number[];
  /** Where they count from. */
  origin: number;
  /** Number of the scan at each time. */
  numbers: number[];
  index: Signal<number>;
  time: ReadonlySignal<number>;
  playing: Signal<boolean>;
  /** Seconds of data shown in one second. */
  speed: ReadonlySignal<number>;
  seek(index: number): void;
  step(by: number): void;
  toggle(): void;
  dispose(): void;
}

export const SPEEDS = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const WHOLE_RUN_S = 15;
const ADDRESS_EVERY_MS = 500;

/** The last index whose time is not after `time`; 0 when all are after it. */
export function indexAt(times: number[], time: number): number {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if ((times[middle] ?? 0) <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}

function usualSpeed(times: number[]): number {
  const span = (times.at(-1) ?? 0) - (times[0] ?? 0);
  return SPEEDS.findLast((speed) => speed <= Math.max(span / WHOLE_RUN_S, 0.5)) ?? 1;
}

export function createClock(times: number[], numbers: number[]): Clock {
  const last = Math.max(times.length - 1, 0);
  const addressed = computed(() => params.value.get("time"));
  const index = signal(last);
  const playing = signal(false);
  const time = computed(() => times[index.value] ?? 0);
  const speed = computed(() => Number(params.value.get("speed")) || usualSpeed(times));
  const followAddress = effect(() => {
    const text = addressed.value;
    if (playing.peek()) return;
    index.value =
      text === null || text === "" || Number.isNaN(Number(text))
        ? last
        : indexAt(times, Number(text));
  });
  const writeAddress = () =>
    setParams({ time: index.peek() === last ? null : times[index.peek()] });
  const seek = (to: number) => {
    index.value = Math.min(Math.max(to, 0), last);
    writeAddress();
  };
  const stopPlaying = effect(() => {
    if (playing.value)
      return play(times, index, speed, () => (playing.value = false), writeAddress);
    return undefined;
  });
  return {
    times,
    origin: originOf(times[0]),
    numbers,
    index,
    time,
    playing,
    speed,
    seek,
    step: (by) => {
      playing.value = false;
      seek(index.peek() + by);
    },
    toggle: () => {
      if (!playing.peek() && index.peek() === last) index.value = 0;
      playing.value = !playing.peek();
    },
    dispose: () => {
      playing.value = false;
      followAddress();
      stopPlaying();
    },
  };
}

/** Runs the clock by the time that really passes: a slow machine drops pictures, not time. */
function play(
  times: number[],
  index: Signal<number>,
  speed: ReadonlySignal<number>,
  ended: () => void,
  writeAddress: () => void,
): () => void {
  let now = times[index.peek()] ?? 0;
  let before = performance.now();
  let written = before;
  const tick = (at: number) => {
    now += (Math.max(at - before, 0) / 1000) * speed.peek();
    before = at;
    index.value = indexAt(times, now);
    if (at - written > ADDRESS_EVERY_MS) {
      written = at;
      writeAddress();
    }
    if (index.peek() >= times.length - 1) ended();
    else request = requestAnimationFrame(tick);
  };
  let request = requestAnimationFrame(tick);
  return () => {
    cancelAnimationFrame(request);
    writeAddress();
  };
}
