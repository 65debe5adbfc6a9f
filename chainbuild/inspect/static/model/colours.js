// The colour of a smallest singular value: red where a motion is lost, teal far from it.

// Decades from exactly singular on. All are dark enough on white and bright enough on black: contrast 3 and more.
const STOPS = [
  [-3, [208, 52, 44]],
  [-2, [212, 96, 24]],
  [-1.3, [174, 128, 0]],
  [-0.7, [47, 150, 88]],
  [0, [31, 139, 158]],
];
const NONE = "rgb(125, 134, 145)"; // no pose, no measure

/** Return where a value stands between 0.001 and 1 on a logarithmic scale, as a share of the way. */
export function traceShare(value) {
  const first = STOPS[0][0];
  return Math.min(Math.max(1 - Math.log10(value) / first, 0), 1);
}

/** Return the colour of a smallest singular value as CSS writes it. */
export function traceColour(value) {
  if (value === null || Number.isNaN(value)) return NONE;
  const place = Math.min(Math.max(Math.log10(value), STOPS[0][0]), 0);
  const next = Math.max(STOPS.findIndex(([end]) => place <= end), 1);
  const [[from, low], [to, high]] = STOPS.slice(next - 1, next + 1);
  const share = (place - from) / (to - from);
  return `rgb(${low.map((v, n) => Math.round(v + share * (high[n] - v))).join(", ")})`;
}
