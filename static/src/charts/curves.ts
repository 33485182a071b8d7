// Closed curves in the plane, as points.

export type Point = [number, number];

const CIRCLE_POINTS = 96;

export function circle(x: number, y: number, radius: number): Point[] {
  return Array.from({ length: CIRCLE_POINTS + 1 }, (_, step) => {
    const angle = (step / CIRCLE_POINTS) * 2 * Math.PI;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

/** The curve at `sigma` standard deviations of a position's covariance `[p_xx, p_xy, p_yy]`. */
export function ellipse(
  x: number,
  y: number,
  [xx, xy, yy]: [number, number, number],
  sigma: number,
): Point[] {
  const middle = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  const major = Math.sqrt(Math.max(middle + spread, 0)) * sigma;
  const minor = Math.sqrt(Math.max(middle - spread, 0)) * sigma;
  const turn = Math.atan2(2 * xy, xx - yy) / 2;
  return Array.from({ length: CIRCLE_POINTS + 1 }, (_, step) => {
    const angle = (step / CIRCLE_POINTS) * 2 * Math.PI;
    const along = major * Math.cos(angle);
    const across = minor * Math.sin(angle);
    return [
      x + along * Math.cos(turn) - across * Math.sin(turn),
      y + along * Math.sin(turn) + across * Math.cos(turn),
    ];
  });
}
