// The clock of the pictures: play, step, drag, how fast, and how much of the past stays drawn.

import type { JSX, TargetedEvent } from "preact";
import { useEffect } from "preact/hooks";
import { Icon, type IconName } from "../components/basics";
import { type Clock, SPEEDS } from "../state/clock";
import { param, setParams } from "../state/url";
import { timeText, utcText } from "../times";

const TRAILS = [1, 2, 5, 10, 20, 50, 100];

export function ClockButton({
  icon,
  label,
  press,
  disabled,
}: {
  icon: IconName;
  label: string;
  press: () => void;
  disabled?: boolean;
}): JSX.Element {
  return (
    <button
      type="button"
      class="clock-button"
      aria-label={label}
      title={label}
      disabled={disabled}
      onClick={press}
    >
      <Icon name={icon} />
    </button>
  );
}

/** What the keyboard does to a clock. */
export function clockKeys(clock: Pick<Clock, "toggle" | "step">): (event: KeyboardEvent) => void {
  return (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    if (target.closest("input:not([type=range]), textarea, select")) return;
    const onRange = target.closest("input[type=range]") !== null;
    if (event.key === " " && !target.closest("button, a, summary")) clock.toggle();
    else if (event.key === "ArrowRight" && !onRange) clock.step(1);
    else if (event.key === "ArrowLeft" && !onRange) clock.step(-1);
    else return;
    event.preventDefault();
  };
}

const lastOf = (clock: Clock): number => Math.max(clock.times.length - 1, 0);

function Buttons({ clock }: { clock: Clock }): JSX.Element {
  const last = lastOf(clock);
  const index = clock.index.value;
  const playing = clock.playing.value;
  return (
    <div class="clock-buttons">
      <ClockButton
        icon="first"
        label="To the first scan"
        press={() => clock.step(-last)}
        disabled={index === 0}
      />
      <ClockButton
        icon="back"
        label="One scan back"
        press={() => clock.step(-1)}
        disabled={index === 0}
      />
      <ClockButton
        icon={playing ? "pause" : "play"}
        label={playing ? "Pause" : "Play"}
        press={clock.toggle}
        disabled={last === 0}
      />
      <ClockButton
        icon="forward"
        label="One scan forward"
        press={() => clock.step(1)}
        disabled={index === last}
      />
      <ClockButton
        icon="last"
        label="To the last scan"
        press={() => clock.step(last)}
        disabled={index === last}
      />
    </div>
  );
}

/** How fast it goes, and how much of the past stays drawn. */
function Choices({ clock }: { clock: Clock }): JSX.Element {
  return (
    <>
      <label class="inline">
        Speed
        <select
          value={String(clock.speed.value)}
          onChange={(event) => setParams({ speed: event.currentTarget.value })}
        >
          {SPEEDS.map((speed) => (
            <option value={String(speed)}>×{speed}</option>
          ))}
        </select>
      </label>
      <label class="inline">
        Trail
        <select
          value={param("trail") ?? ""}
          onChange={(event) => setParams({ trail: event.currentTarget.value })}
        >
          <option value="">all</option>
          {TRAILS.map((scans) => (
            <option value={String(scans)}>
              {scans} {scans === 1 ? "scan" : "scans"}
            </option>
          ))}
        </select>
      </label>
    </>
  );
}

export function ClockBar({ clock }: { clock: Clock }): JSX.Element {
  useEffect(() => {
    const listener = clockKeys(clock);
    document.addEventListener("keydown", listener);
    return () => document.removeEventListener("keydown", listener);
  }, [clock]);
  const last = lastOf(clock);
  const index = clock.index.value;
  const time = timeText(clock.time.value, clock.origin);
  const drag = (event: TargetedEvent<HTMLInputElement>) => {
    clock.playing.value = false;
    clock.seek(Number(event.currentTarget.value));
  };
  return (
    <div class="clock" role="group" aria-label="Clock">
      <Buttons clock={clock} />
      <input
        class="clock-slider"
        type="range"
        min={0}
        max={last}
        step={1}
        value={index}
        aria-label="Scan"
        aria-valuetext={`scan ${clock.numbers[index]} of ${clock.numbers.at(-1)}, ${time}`}
        onInput={drag}
      />
      <output class="clock-text">
        <b>{time}</b> scan {clock.numbers[index]}/{clock.numbers.at(-1)}
        {clock.origin ? <span class="sub">{utcText(clock.time.value)}</span> : null}
      </output>
      <Choices clock={clock} />
    </div>
  );
}
