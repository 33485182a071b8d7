// Light, dark, or as the system says. The choice stands in the address; the browser remembers the
// last one.

import { computed, effect, signal } from "@preact/signals";
import { params, setParams } from "./url";

export type ThemeChoice = "system" | "light" | "dark";

const STORAGE_KEY = "trackloom.theme";
const systemDark = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(systemDark.matches);
systemDark.addEventListener("change", (event) => (systemIsDark.value = event.matches));

function asChoice(text: string | null): ThemeChoice {
  return text === "light" || text === "dark" ? text : "system";
}

function remembered(): string | null {
  try {
    return localStorage.getItem(STORAGE_KEY);
  } catch {
    return null; // storage may be forbidden; then the system decides
  }
}

export const themeChoice = computed(() => asChoice(params.value.get("theme") ?? remembered()));

export const theme = computed<"light" | "dark">(() => {
  if (themeChoice.value !== "system") return themeChoice.value;
  return systemIsDark.value ? "dark" : "light";
});

export function chooseTheme(choice: ThemeChoice): void {
  try {
    localStorage.setItem(STORAGE_KEY, choice);
  } catch {
    // the address still keeps the choice
  }
  setParams({ theme: choice });
}

effect(() => {
  document.documentElement.dataset.theme = theme.value;
});

/** Colours of the drawing, read from the style sheet so that there is one palette. */
export interface Palette {
  text: string;
  muted: string;
  line: string;
  strongLine: string;
  surface: string;
  truth: string;
  track: string;
  tentative: string;
  selected: string;
  good: string;
  bad: string;
  odd: string;
  sensors: string[];
}

export function readPalette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const read = (name: string) => style.getPropertyValue(name).trim();
  return {
    text: read("--text"),
    muted: read("--muted"),
    line: read("--line"),
    strongLine: read("--strong-line"),
    surface: read("--surface"),
    truth: read("--chart-truth"),
    track: read("--chart-track"),
    tentative: read("--chart-tentative"),
    selected: read("--chart-selected"),
    good: read("--good"),
    bad: read("--bad"),
    odd: read("--odd"),
    sensors: [1, 2, 3, 4, 5].map((number) => read(`--chart-sensor-${number}`)),
  };
}
