// Units and angles of axis values, as Python's `units` and `frames` have them: mm and degrees become SI here only.

const RAD_PER_DEG = Math.PI / 180;
const RIGHT_ANGLE_DEG = 1e-12; // this close to a multiple of 90 degrees an angle is taken as exact
const RIGHT_ANGLES = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/** Return metres for millimetres (divided, so that decimal input stays decimal). */
export const metres = (mm) => mm / 1000;

/** Return millimetres for metres. */
export const millimetres = (m) => m * 1000;

/** Return radians for degrees. */
export const radians = (deg) => deg * RAD_PER_DEG;

/** Return degrees for radians. */
export const degrees = (rad) => rad / RAD_PER_DEG;

/** Return a sine or cosine without the excess over 1 that rounding leaves. */
export const withinOne = (ratio) => Math.max(-1, Math.min(1, ratio));

/** Return a size with the sign of another number, that of a negative zero, too. */
export const withSign = (size, like) => (like < 0 || Object.is(like, -0) ? -Math.abs(size) : Math.abs(size));

/** Return a value less the nearest multiple of a whole, exactly; halfway the even multiple is taken off. */
export function remainder(value, whole) {
  const rest = value % whole;
  const twice = 2 * Math.abs(rest);
  const odd = Math.abs(value % (2 * whole)) >= whole;
  return twice > whole || (twice === whole && odd) ? rest - withSign(whole, rest) : rest;
}

/** Return cosine and sine of an angle in degrees, exact at multiples of 90. */
export function cosSinDeg(angle) {
  const quarter = Math.round(angle / 90);
  if (Math.abs(angle - 90 * quarter) <= RIGHT_ANGLE_DEG) return RIGHT_ANGLES[((quarter % 4) + 4) % 4];
  return [Math.cos(radians(angle)), Math.sin(radians(angle))];
}

/** Return the direction (cosine, sine) of an azimuth in degrees, first brought to half a turn either way. */
export const azimuth = (angle) => cosSinDeg(remainder(angle, 360));
