// Where the names of marks stand, so that none is printed over another or over a mark.

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

const HEIGHT = 13;
const DIGIT_PX = 6.3;
const AWAY_PX = 11;
/** More than a drawing has rows of cells. */
const ROWS = 4096;

export interface Named {
  name: string;
  x: number;
  y: number;
}

export interface Label extends Named {
  anchor: "start" | "end" | "middle";
}

const meets = (one: Box, other: Box): boolean =>
  one.x < other.x + other.width &&
  other.x < one.x + one.width &&
  one.y < other.y + other.height &&
  other.y < one.y + one.height;

function spots({ name, x, y }: Named): [Label, Box][] {
  const width = name.length * DIGIT_PX;
  const box = (left: number, middle: number): Box => ({
    x: left,
    y: middle - HEIGHT / 2,
    width,
    height: HEIGHT,
  });
  const beside = (dx: number, dy: number, anchor: Label["anchor"]): [Label, Box] => {
    const left = anchor === "start" ? x + dx : anchor === "end" ? x + dx - width : x - width / 2;
    return [{ name, x: x + dx, y: y + dy, anchor }, box(left, y + dy)];
  };
  return [
    beside(AWAY_PX, 0, "start"),
    beside(-AWAY_PX, 0, "end"),
    beside(0, -AWAY_PX - 4, "middle"),
    beside(0, AWAY_PX + 4, "middle"),
  ];
}

/**
 * The labels that find room: the first ones choose first, and what finds none is left out. `taken`
 * are the marks; each name may lie over its own.
 */
export function placed(names: Named[], taken: Box[]): Label[] {
  const cells = new Map<number, Box[]>();
  const cellsOf = ({ x, y, width, height }: Box): number[] => {
    const keys: number[] = [];
    for (let column = Math.floor(x / 64); column <= Math.floor((x + width) / 64); column++)
      for (let row = Math.floor(y / 64); row <= Math.floor((y + height) / 64); row++)
        keys.push(column * ROWS + row);
    return keys;
  };
  const add = (box: Box) => {
    for (const key of cellsOf(box)) {
      const there = cells.get(key);
      if (there) there.push(box);
      else cells.set(key, [box]);
    }
  };
  const isFree = (box: Box) =>
    cellsOf(box).every((key) => !(cells.get(key) ?? []).some((other) => meets(box, other)));
  for (const box of taken) add(box);
  return names.flatMap((named) => {
    const found = spots(named).find(([, box]) => isFree(box));
    if (!found) return [];
    add(found[1]);
    return [found[0]];
  });
}
