// Pose angles of a rotation, and a rotation of pose angles; see frames.py.
import { multiply, turnAbout } from "cb/linear";

const LOCK = 1e-9; // below this cosine of the middle angle the first and the third cannot be told apart
const UNITS = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const DEGREES = 180 / Math.PI;

/** Return A, B, C in degrees of a transform's rotation; at gimbal lock the angle of the first factor is 0. */
export function poseAngles(factors, T) {
  const R = (row, col) => T[4 * row + col];
  const [i, j, last] = factors.map(([axis]) => "xyz".indexOf(axis));
  const k = 3 - i - j;
  const parity = (j - i + 3) % 3 === 1 ? 1 : -1;
  let raw;
  if (i === last) {
    const sine = Math.hypot(R(j, i), R(k, i));
    raw = sine < LOCK
      ? [0, Math.atan2(sine, R(i, i)), Math.atan2(-parity * R(j, k), R(j, j))]
      : [Math.atan2(R(j, i), -parity * R(k, i)), Math.atan2(sine, R(i, i)), Math.atan2(R(i, j), parity * R(i, k))];
  } else {
    const cosine = Math.hypot(R(i, i), R(i, j));
    const middle = Math.atan2(parity * R(i, k), cosine);
    raw = cosine < LOCK
      ? [0, middle, Math.atan2(parity * R(j, i), R(j, j))]
      : [Math.atan2(-parity * R(j, k), R(k, k)), middle, Math.atan2(-parity * R(i, j), R(i, i))];
  }
  const angles = [0, 0, 0];
  factors.forEach(([, letter, sign], n) => {
    const angle = sign * raw[n] * DEGREES;
    angles["ABC".indexOf(letter)] = angle === -180 ? 180 : angle + 0;
  });
  return angles;
}

/** Return the transform that turns by A, B, C in degrees and shifts to a position in metres. */
export function fromAngles(factors, angles, [x, y, z]) {
  const turns = factors.map(([axis, letter, sign]) => {
    return turnAbout(UNITS[axis], (sign * angles["ABC".indexOf(letter)]) / DEGREES);
  });
  const T = multiply(multiply(turns[0], turns[1]), turns[2]);
  [T[3], T[7], T[11]] = [x, y, z];
  return T;
}
