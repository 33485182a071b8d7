// The levels of a bearing-time record as shades: blocks of cells with their mean power, the palest
// third of them clear.

export interface Levels {
  rows: number;
  columns: number;
  /** Mean level of each block, row by row (dB). */
  level_db: Float32Array;
  /** Edges of the record. */
  fromBearing: number;
  toBearing: number;
  fromTime: number;
  toTime: number;
  /** Levels that are clear, and that are darkest (dB). */
  low: number;
  high: number;
  /** Cells that a block is the mean of. */
  perBlock: number;
}

const MOST_ROWS = 600;
const MOST_COLUMNS = 720;
const PALEST = 0.3;
const DARKEST = 0.995;

/** Reads the canonical file: `time_s` and the bearings in the header, then a row a time. */
export function readLevels(text: string): Levels | undefined {
  const lines = text.trimEnd().split("\n");
  const bearings = (lines[0] ?? "").split(",").slice(1).map(Number);
  const count = lines.length - 1;
  if (count < 2 || bearings.length < 2) return undefined;
  const [down, across] = [Math.ceil(count / MOST_ROWS), Math.ceil(bearings.length / MOST_COLUMNS)];
  const [rows, columns] = [Math.ceil(count / down), Math.ceil(bearings.length / across)];
  const power = new Float64Array(rows * columns);
  const cells = new Uint32Array(rows * columns);
  const times: number[] = [];
  for (let line = 0; line < count; line++) {
    const values = (lines[line + 1] ?? "").split(",");
    times.push(Number(values[0]));
    for (let cell = 0; cell < bearings.length; cell++) {
      const block = Math.floor(line / down) * columns + Math.floor(cell / across);
      power[block] = (power[block] ?? 0) + 10 ** (Number(values[cell + 1]) / 10);
      cells[block] = (cells[block] ?? 0) + 1;
    }
  }
  const level_db = Float32Array.from(
    power,
    (sum, block) => 10 * Math.log10(sum / Math.max(cells[block] ?? 1, 1)),
  );
  const sorted = Float32Array.from(level_db).sort();
  const at = (share: number) => sorted[Math.floor(share * (sorted.length - 1))] ?? 0;
  const [first, last, step] = [
    bearings[0] ?? 0,
    bearings.at(-1) ?? 0,
    (bearings[1] ?? 0) - (bearings[0] ?? 0),
  ];
  const period = ((times.at(-1) ?? 0) - (times[0] ?? 0)) / (count - 1);
  return {
    rows,
    columns,
    level_db,
    fromBearing: first - step / 2,
    toBearing: last + step / 2,
    fromTime: (times[0] ?? 0) - period / 2,
    toTime: (times.at(-1) ?? 0) + period / 2,
    low: at(PALEST),
    high: at(DARKEST),
    perBlock: down * across,
  };
}

const drawn = new WeakMap<Levels, { color: string; image: HTMLCanvasElement }>();

/** The shades of one colour, from clear to nearly full. */
export function shades(levels: Levels, color: string): HTMLCanvasElement {
  const before = drawn.get(levels);
  if (before?.color === color) return before.image;
  const image = document.createElement("canvas");
  [image.width, image.height] = [levels.columns, levels.rows];
  const pen = image.getContext("2d");
  if (pen) {
    pen.fillStyle = color;
    pen.fillRect(0, 0, 1, 1);
    const [red = 0, green = 0, blue = 0] = pen.getImageData(0, 0, 1, 1).data;
    const pixels = pen.createImageData(levels.columns, levels.rows);
    levels.level_db.forEach((level, block) => {
      const share = Math.min(
        Math.max((level - levels.low) / Math.max(levels.high - levels.low, 1e-9), 0),
        1,
      );
      pixels.data.set([red, green, blue, Math.round(share * 150)], block * 4);
    });
    pen.putImageData(pixels, 0, 0);
  }
  drawn.set(levels, { color, image });
  return image;
}
