// The colour of a smallest singular value: red where a motion is lost, teal far from it.

// Decades from exactly singular on. All are dark enough on white and bright enough on black: contrast 3 and more.
const STOPS = [
  [-3, [208, 52, 44]],
  [-2, [212, 96, 24]],
  [-1.3, [174, 128, 0]],
  [-0.7, [47, 150, 88]],
  [0, [31, 139, 158]],
];
const NONE = [125, 134, 145]; // no pose, no measure
export const LOWEST = 10 ** STOPS[0][0]; // ends of the scale
export const HIGHEST = 1;

/** Return where a value stands between 0.001 and 1 on a logarithmic scale, as a share of the way. */
export function traceShare(value) {
  return Math.min(Math.max(1 - Math.log10(value) / STOPS[0][0], 0), 1);
}

/** Return the colour of a smallest singular value as [red, green, blue] in 0 … 255; grey where there is none. */
export function traceRGB(value) {
  if (value === null || Number.isNaN(value)) return NONE;
  const place = Math.min(Math.max(Math.log10(value), STOPS[0][0]), 0);
  const next = Math.max(STOPS.findIndex(([end]) => place <= end), 1);
  const [[from, low], [to, high]] = STOPS.slice(next - 1, next + 1);
  const share = (place - from) / (to - from);
  return low.map((v, n) => v + share * (high[n] - v));
}

/** Return the same colour as CSS writes it. */
export const traceColour = (value) => `rgb(${traceRGB(value).map(Math.round).join(", ")})`;
