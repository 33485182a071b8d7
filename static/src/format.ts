// Numbers, times and sizes as people read them.

export function count(value: number | null | undefined): string {
  return value === null || value === undefined ? "–" : value.toLocaleString("en-US");
}

/** Four significant digits, no exponent in the usual range. */
export function number(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e7)) return value.toExponential(3);
  return String(Number(value.toPrecision(size >= 1000 ? 7 : 4)));
}

/** A length to the decimetre, as positions are read. */
export function metres(value: number): string {
  return value.toFixed(1);
}

export function probability(value: number | null | undefined): string {
  return value === null || value === undefined ? "–" : value.toFixed(3);
}

export function duration(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return "–";
  if (seconds === 0) return "–";
  if (seconds < 0.001) return `${(seconds * 1e6).toFixed(0)} µs`;
  if (seconds < 1) return `${(seconds * 1000).toFixed(seconds < 0.01 ? 1 : 0)} ms`;
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const minutes = Math.floor(seconds / 60);
  if (minutes < 60) return `${minutes} min ${Math.floor(seconds % 60)} s`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

const pad = (value: number) => String(value).padStart(2, "0");

/** Local time, the day only when it is not today. */
export function moment(text: string | null | undefined): string {
  if (!text) return "–";
  const at = new Date(text);
  const clock = `${pad(at.getHours())}:${pad(at.getMinutes())}:${pad(at.getSeconds())}`;
  const sameDay = at.toDateString() === new Date().toDateString();
  return sameDay ? clock : `${day(text)} ${clock.slice(0, 5)}`;
}

/** Local day. */
export function day(text: string): string {
  const at = new Date(text);
  return `${at.getFullYear()}-${pad(at.getMonth() + 1)}-${pad(at.getDate())}`;
}

export function bytes(value: number): string {
  if (value < 1000) return `${value} B`;
  if (value < 1e6) return `${(value / 1e3).toFixed(1)} kB`;
  return value < 1e9 ? `${(value / 1e6).toFixed(1)} MB` : `${(value / 1e9).toFixed(2)} GB`;
}

export function seconds(
  from: string | null | undefined,
  to: string | null | undefined,
): number | null {
  if (!from) return null;
  return Math.max(0, ((to ? Date.parse(to) : Date.now()) - Date.parse(from)) / 1000);
}

/**
 * A field's name without its unit: `max_range_m` → "max range"; symbols such as `p_d` stay as they
 * are.
 */
export function words(name: string): string {
  const bare = name.replace(/_(m|s|mps|m2ps3|deg|hz)$/, "");
  return /_[a-z]$/.test(bare) ? bare : bare.replaceAll("_", " ");
}

export function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** `1 track`, `2 tracks`. */
export function plural(value: number, one: string, many = `${one}s`): string {
  return `${count(value)} ${value === 1 ? one : many}`;
}

export function intervalText({ low, high }: { low: number; high: number }): string {
  return `[${number(low)}, ${number(high)}]`;
}
