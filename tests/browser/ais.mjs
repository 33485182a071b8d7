// AIS sentences made here: six bits a character as ITU-R M.1371 lays them out, and checksums as
// NMEA 0183 has them.

/** Exclusive or of all characters, as two hexadecimal digits. */
function checksum(text) {
  const sum = [...text].reduce((value, letter) => value ^ letter.charCodeAt(0), 0);
  return sum.toString(16).toUpperCase().padStart(2, "0");
}

const bits = (value, length) =>
  BigInt.asUintN(length, BigInt(value)).toString(2).padStart(length, "0");

/** Six bits a character, from `0` to `W` and from a backquote to `w`. */
function armoured(payload) {
  const sixes = payload.match(/.{1,6}/g).map((six) => Number.parseInt(six.padEnd(6, "0"), 2));
  return sixes.map((six) => String.fromCharCode(six < 40 ? six + 48 : six + 56)).join("");
}

/** A sentence that was received at a Unix time. */
export function sentence(payload, unix_s) {
  const body = `AIVDM,1,1,,A,${armoured(payload)},0`;
  const tag = `c:${unix_s}`;
  return `\\${tag}*${checksum(tag)}\\!${body}*${checksum(body)}`;
}

/** A position report of class A (message 1), which says the second of the minute. */
export function position(mmsi, lat_deg, lon_deg, unix_s) {
  const fields = [
    [1, 6],
    [0, 2],
    [mmsi, 30],
    [0, 4],
    [0, 8],
    [100, 10],
    [1, 1],
    [Math.round(lon_deg * 600_000), 28],
    [Math.round(lat_deg * 600_000), 27],
    [900, 12],
    [90, 9],
    [unix_s % 60, 6],
    [0, 2],
    [0, 3],
    [0, 1],
    [0, 19],
  ];
  return fields.map(([value, length]) => bits(value, length)).join("");
}

/** A report of a base station (message 4), which is no ship. */
export const baseStation = (mmsi) =>
  `${bits(4, 6)}${bits(0, 2)}${bits(mmsi, 30)}${"0".repeat(130)}`;
