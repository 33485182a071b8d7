// Names that a column of a file can be read as, for whoever types one. The service judges; a test
// holds that nothing it allows is missing here.

const upper = (names: string[]): string[] =>
  names.flatMap((row, at) => names.slice(at).map((column) => `p_${row}${column}`));

const PLACES = ["x_m", "y_m", "z_m", "lat_deg", "lon_deg", "height_m"];
const MEASURED = ["range_m", "bearing_deg", "elevation_deg", "range_rate_mps"];
const MOVING = ["vx_mps", "vy_mps", "vz_mps", "speed_mps", "course_deg", "bearing_rate_degps"];
const IDENTITIES = ["scan", "sensor_id", "detection_id", "truth_id", "track_id"];
const OTHERS = ["amplitude", "probability", "status", "nis", "existence", "time_base"];
/** How probable each motion model of a track is. */
const MODES = [1, 2, 3, 4, 5, 6].map((model) => `mode_${model}`);
/** Where a sensor that moves is, how fast, how it is turned, and how well that is known. */
const KINEMATICS = ["x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps"];
const POSE = [...KINEMATICS, "heading_deg", "pitch_deg", "roll_deg"];
const POSES = [...POSE, ...POSE.map((name) => `sigma_${name}`)].map((name) => `sensor_${name}`);
const SIGMAS = [
  ...["x_m", "y_m", "z_m", "range_m", "bearing_deg", "elevation_deg", "range_rate_mps"],
  ...["speed_mps", "course_deg"],
].map((name) => `sigma_${name}`);
const ATTRIBUTES = [
  "address",
  "callsign",
  "mode_a",
  "mode_c_ft",
  "position_accuracy_m",
  "mmsi",
  "ship_name",
  "ship_type",
  "track_number",
  "on_ground",
  "report_kind",
];
const COVARIANCES = [...upper(["x", "y", "z", "vx", "vy", "vz"]), "p_bb", "p_bbr", "p_brbr"];

/** Units that the columns of a file may have in place of those in their canonical names. */
const UNITS: [RegExp, string[]][] = [
  [/_mps$/, ["kt", "km/h", "ft/min", "mph"]],
  [/_m$/, ["km", "ft", "NM", "FL", "yd", "mi", "cm", "mm"]],
  [/_deg$/, ["rad", "mil"]],
  [/_s$/, ["ms", "us", "ns", "min", "h"]],
  [/_ft$/, ["m", "FL"]],
];

function inUnits(name: string): string[] {
  const [, units = []] = UNITS.find(([ending]) => ending.test(name)) ?? [];
  return [name, ...units.map((unit) => `${name} [${unit}]`)];
}

/** Every canonical name, those with units also with the units that a file may have. */
export const CANONICAL: string[] = [
  ...["time_s", "known_at_s", ...PLACES, ...MEASURED, ...MOVING].flatMap(inUnits),
  ...IDENTITIES,
  ...OTHERS,
  ...MODES,
  ...ATTRIBUTES.flatMap(inUnits),
  ...POSES.flatMap(inUnits),
  ...SIGMAS.flatMap(inUnits),
  "correlation_xy",
  ...COVARIANCES,
];
