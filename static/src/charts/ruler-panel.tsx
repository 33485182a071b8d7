// The points of the ruler as numbers, for the keyboard and for exact places; and what it measures.

import type { JSX } from "preact";
import { Icon } from "../components/basics";
import { setParams } from "../state/url";
import { type Ruler, rulerText, rulerWords, type Spot } from "./ruler";

function change(ruler: Ruler, end: "from" | "to", axis: "x" | "y", text: string): void {
  const value = Number(text);
  if (text.trim() === "" || !Number.isFinite(value)) return;
  const from: Spot = { x: 0, y: 0, ...ruler.from };
  const next: Ruler =
    end === "from"
      ? { ...ruler, from: { ...from, [axis]: value } }
      : { from, to: { ...from, ...ruler.to, [axis]: value } };
  setParams({ ruler: rulerText(next) });
}

export function RulerPanel({ ruler }: { ruler: Ruler }): JSX.Element {
  const field = (end: "from" | "to", axis: "x" | "y") => {
    const name = `${end} ${axis} (m)`;
    const value = ruler[end]?.[axis];
    return (
      <label class="inline">
        {name}
        <input
          type="number"
          step="any"
          value={value === undefined ? "" : Number(value.toFixed(2))}
          onChange={(event) => change(ruler, end, axis, event.currentTarget.value)}
        />
      </label>
    );
  };
  return (
    <div class="ruler" role="group" aria-label="Ruler">
      {field("from", "x")}
      {field("from", "y")}
      {field("to", "x")}
      {field("to", "y")}
      <output class="ruler-result">
        {rulerWords(ruler) ?? <span class="muted">drag, or press two points</span>}
      </output>
      <button type="button" class="quiet" onClick={() => setParams({ ruler: null })}>
        <Icon name="close" /> Put away
      </button>
    </div>
  );
}
