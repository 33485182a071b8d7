// The clock of a live session: it follows the feed, or stays at a moment that the page still has.

import type { JSX, TargetedEvent } from "preact";
import { useEffect } from "preact/hooks";
import { ClockButton, clockKeys } from "../charts/clock-bar";
import type { LiveProps } from "./live-plan";
import { clockText, clockTitle } from "./time";

export function LiveClock({ follower, at }: LiveProps): JSX.Element {
  const { moments } = follower.memory;
  const last = moments.length - 1;
  const move = (index: number) => {
    at.value = moments[Math.min(Math.max(index, 0), moments.length - 1)]?.time;
  };
  const place = () => {
    const time = at.peek();
    const found = time === undefined ? -1 : moments.findLastIndex((moment) => moment.time <= time);
    return found < 0 ? (time === undefined ? moments.length - 1 : 0) : found;
  };
  const step = (by: number) => move(place() + by);
  const toggle = () => {
    if (at.peek() === undefined) move(moments.length - 1);
    else at.value = undefined;
  };
  useEffect(() => {
    const listener = clockKeys({ step, toggle });
    document.addEventListener("keydown", listener);
    return () => document.removeEventListener("keydown", listener);
  }, [follower]);
  void follower.picture.value;
  const isFollowing = at.value === undefined;
  const index = place();
  const moment = moments[index];
  const drag = (event: TargetedEvent<HTMLInputElement>) => move(Number(event.currentTarget.value));
  const text = moment ? clockText(moment.time) : "no scan yet";
  return (
    <div class="clock" role="group" aria-label="Clock">
      <div class="clock-buttons">
        <ClockButton
          icon="back"
          label="One picture back"
          press={() => step(-1)}
          disabled={index <= 0}
        />
        <ClockButton
          icon="forward"
          label="One picture forward"
          press={() => step(1)}
          disabled={index >= last}
        />
      </div>
      <button type="button" class="follow" aria-pressed={isFollowing} onClick={toggle}>
        {isFollowing ? "Following" : "Follow"}
      </button>
      <input
        class="clock-slider"
        type="range"
        min={0}
        max={Math.max(last, 0)}
        step={1}
        value={Math.max(index, 0)}
        disabled={last < 1}
        aria-label="Picture"
        aria-valuetext={text}
        onInput={drag}
      />
      <output class="clock-text" title={moment ? clockTitle(moment.time) : undefined}>
        <b>{text}</b> {moment ? `scan ${moment.scan}` : ""}
        <span class="sub">
          {isFollowing ? following(follower) : behind(moments.length - 1 - index)}
        </span>
      </output>
    </div>
  );
}

function following({ bond }: LiveProps["follower"]): string {
  return bond.value === "ended" ? "the newest there was" : "follows the feed";
}

function behind(pictures: number): string {
  return pictures <= 0 ? "stays here" : `stays, ${pictures} behind`;
}
