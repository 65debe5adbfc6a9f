// Vectors as [x, y, z], transforms as 16 numbers row by row, matrices as arrays of rows.

export const identity = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Return the product of two transforms. */
export function multiply(A, B) {
  const C = new Array(16);
  for (let r = 0; r < 12; r += 4) {
    for (let c = 0; c < 4; c += 1) {
      C[r + c] = A[r] * B[c] + A[r + 1] * B[4 + c] + A[r + 2] * B[8 + c] + A[r + 3] * B[12 + c];
    }
  }
  C[12] = C[13] = C[14] = 0;
  C[15] = 1;
  return C;
}

/** Return the inverse of a rigid transform. */
export function inverse(T) {
  const x = -(T[0] * T[3] + T[4] * T[7] + T[8] * T[11]);
  const y = -(T[1] * T[3] + T[5] * T[7] + T[9] * T[11]);
  const z = -(T[2] * T[3] + T[6] * T[7] + T[10] * T[11]);
  return [T[0], T[4], T[8], x, T[1], T[5], T[9], y, T[2], T[6], T[10], z, 0, 0, 0, 1];
}

/** Return the turn about a unit vector by an angle in radians. */
export function turnAbout([x, y, z], angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const d = 1 - c;
  return [
    c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0,
    d * y * x + s * z, c + d * y * y, d * y * z - s * x, 0,
    d * z * x - s * y, d * z * y + s * x, c + d * z * z, 0,
    0, 0, 0, 1,
  ];
}

/** Return the shift along a vector in metres. */
export const shiftBy = ([x, y, z]) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1];

/** Return the origin of a transform. */
export const originOf = (T) => [T[3], T[7], T[11]];

/** Return a column of a transform's rotation. */
export const column = (T, n) => [T[n], T[4 + n], T[8 + n]];

/** Return the rotation of a transform applied to a vector. */
export const rotate = (T, v) => [
  T[0] * v[0] + T[1] * v[1] + T[2] * v[2],
  T[4] * v[0] + T[5] * v[1] + T[6] * v[2],
  T[8] * v[0] + T[9] * v[1] + T[10] * v[2],
];

/** Return the inverse rotation of a transform applied to a vector. */
export const rotateBack = (T, v) => [
  T[0] * v[0] + T[4] * v[1] + T[8] * v[2],
  T[1] * v[0] + T[5] * v[1] + T[9] * v[2],
  T[2] * v[0] + T[6] * v[1] + T[10] * v[2],
];

/** Return the rotation vector of a transform's rotation. */
export function logRotation(T) {
  const axis = [T[9] - T[6], T[2] - T[8], T[4] - T[1]];
  const sine = Math.sqrt(dot(axis, axis)) / 2;
  const cosine = (T[0] + T[5] + T[10] - 1) / 2;
  const angle = Math.atan2(sine, cosine);
  if (sine > 1e-7) return axis.map((v) => (v * angle) / (2 * sine));
  if (cosine > 0) return axis.map((v) => v / 2);
  // Close to half a turn the difference of the off-diagonals vanishes: the axis is the largest column of R + 1.
  const R = [[T[0] + 1, T[1], T[2]], [T[4], T[5] + 1, T[6]], [T[8], T[9], T[10] + 1]];
  const n = [0, 1, 2].reduce((best, k) => (R[k][k] > R[best][best] ? k : best), 0);
  const u = [R[0][n], R[1][n], R[2][n]];
  const size = Math.sqrt(dot(u, u)) * (dot(u, axis) < 0 ? -1 : 1);
  return u.map((v) => (v * angle) / size);
}

/** Return the smallest turn, as a rotation vector, that brings a coordinate axis to a direction of length 1. */
export function tilt(direction, axis) {
  const i = (axis + 1) % 3;
  const j = (axis + 2) % 3;
  const sine = Math.hypot(direction[i], direction[j]);
  const turn = [0, 0, 0];
  if (sine < 1e-15) {
    turn[i] = direction[axis] > 0 ? 0 : Math.PI; // exactly opposite: any half turn will do
    return turn;
  }
  const scale = Math.atan2(sine, direction[axis]) / sine;
  turn[i] = -direction[j] * scale;
  turn[j] = direction[i] * scale;
  return turn;
}

/** Return the product of a matrix (array of rows) and a vector. */
export const apply = (rows, v) => rows.map((row) => row.reduce((sum, value, n) => sum + value * v[n], 0));

/** Return the damped least-squares step (JᵀJ + λ·1)⁻¹·Jᵀ·e of a matrix (array of rows). */
export function dampedStep(J, error, damping) {
  const short = J.length < (J[0] || []).length;
  const A = short ? J : transposed(J);
  const square = A.map((row) => A.map((other) => row.reduce((sum, v, n) => sum + v * other[n], 0)));
  square.forEach((row, n) => { row[n] += damping; });
  if (short) return apply(transposed(J), solved(square, error.slice()));
  return solved(square, apply(A, error));
}

/** Return the rows of the transposed matrix. */
export const transposed = (rows) => (rows.length ? rows[0].map((_, n) => rows.map((row) => row[n])) : []);

/** Return x of A·x = b for a symmetric positive definite matrix, by Cholesky's method; both are overwritten. */
function solved(A, b) {
  const n = b.length;
  for (let k = 0; k < n; k += 1) {
    for (let r = k; r < n; r += 1) {
      let sum = A[r][k];
      for (let m = 0; m < k; m += 1) sum -= A[r][m] * A[k][m];
      A[r][k] = r === k ? Math.sqrt(Math.max(sum, 1e-300)) : sum / A[k][k];
    }
  }
  for (let k = 0; k < n; k += 1) {
    for (let m = 0; m < k; m += 1) b[k] -= A[k][m] * b[m];
    b[k] /= A[k][k];
  }
  for (let k = n - 1; k >= 0; k -= 1) {
    for (let m = k + 1; m < n; m += 1) b[k] -= A[m][k] * b[m];
    b[k] /= A[k][k];
  }
  return b;
}

/**
 * Return singular values, falling, and the vectors of the smallest: one-sided Jacobi, which keeps all digits of small ones.
 * @param {number[][]} rows the matrix
 * @returns {{values: number[], left: number[], right: number[]}} left: unit vector over the rows; right: over the columns
 */
export function singular(rows) {
  const wide = rows.length < rows[0].length;
  // Columns of the taller one are turned until they are orthogonal; V gathers the turns.
  const U = wide ? rows.map((row) => row.slice()) : transposed(rows);
  const V = U.map((_, n) => U.map((__, m) => (n === m ? 1 : 0)));
  for (let sweep = 0; sweep < 40; sweep += 1) {
    let turned = false;
    for (let p = 0; p < U.length - 1; p += 1) {
      for (let q = p + 1; q < U.length; q += 1) turned = orthogonalised(U, V, p, q) || turned;
    }
    if (!turned) break;
  }
  const sizes = U.map((row) => Math.hypot(...row));
  const order = sizes.map((_, n) => n).sort((a, b) => sizes[b] - sizes[a]);
  const last = order[order.length - 1];
  const along = U[last].map((v) => (sizes[last] > 0 ? v / sizes[last] : 0));
  return {
    values: order.map((n) => sizes[n]),
    left: wide ? V[last] : along,
    right: wide ? along : V[last],
  };
}

function orthogonalised(U, V, p, q) {
  let a = 0;
  let b = 0;
  let c = 0;
  for (let n = 0; n < U[p].length; n += 1) {
    a += U[p][n] * U[p][n];
    b += U[q][n] * U[q][n];
    c += U[p][n] * U[q][n];
  }
  if (c === 0 || Math.abs(c) <= 1e-16 * Math.sqrt(a * b)) return false;
  const zeta = (b - a) / (2 * c);
  const t = (zeta >= 0 ? 1 : -1) / (Math.abs(zeta) + Math.sqrt(1 + zeta * zeta));
  const cs = 1 / Math.sqrt(1 + t * t);
  const sn = cs * t;
  [U, V].forEach((M) => {
    for (let n = 0; n < M[p].length; n += 1) {
      const x = M[p][n];
      M[p][n] = cs * x - sn * M[q][n];
      M[q][n] = sn * x + cs * M[q][n];
    }
  });
  return true;
}
