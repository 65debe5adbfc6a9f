// Three rods that carry a table (19), and where the table stands: the way from home.
//
// A guide leaves the table three freedoms: the height h and a tilt without torsion, the quaternion (w, x, y, 0). Three
// equations have up to 16 solutions; the one in force continues from the level table at equal heights. Formulas and
// step control are those of Python's `maps/table_rods.py`: another step would end elsewhere near a singular position.

const STEP = 0.06; // change of (x, y) in one step: 7 deg of tilt
const CORRECTED = 0.25; // share of a step that may be left to Newton's method: with less it stays at its own solution
const SLIGHT = 1e-6; // change of (x, y) that is never too much
const SHORTEST = 1e-7; // step, as a share of the way, which ends there
const ROUGH = 1e-5; // last change by Newton's method on the way: its square is left, and the next step starts there
const FINE = 1e-10; // the same at the end of the way: what is left is rounding
const NEWTONS = 8; // steps: two or three do
const UPRIGHT = 0.5; // x² + y² of a table that stands upright: the tool does not reach its face beyond

/** The rods of one machine. */
export class TableRods {
  constructor(data) {
    Object.assign(this, data);
    // Height [m] of the level table over carriages at 0.
    this.home = -data.hanging * Math.sqrt(data.length ** 2 - (data.columns - data.table) ** 2);
    // Whether a rod may come to lie flat before the table stands upright, and its carriage pass the table.
    this.mayLieFlat = data.length <= Math.max(data.columns + data.table / 2, 1.5 * data.table - data.columns);
  }

  // Place of the table's centre [m]: g·(x - i·y)².
  centre(x, y) {
    const [re, im] = this.offset;
    const real = x * x - y * y;
    const imaginary = -2 * x * y;
    return [re * real - im * imaginary, re * imaginary + im * real];
  }

  // The rods at (h, x, y), whatever their length there: [way from carriage to table, by x, by y]; by h is upwards.
  rods([h, x, y], heights) {
    const w = Math.sqrt(1 - x * x - y * y);
    const double = 2 * this.table;
    const level = this.table - this.columns;
    const [cx, cy] = this.centre(x, y);
    const [re, im] = this.offset;
    const along = 2 * (re * x + im * y);
    const aside = 2 * (im * x - re * y); // (aside, -along) by y
    return this.directions.map(([ex, ey], n) => {
      const arm = x * ey - y * ex; // of the joint about the axis of the tilt: it rises by 2·w·r of it
      return [
        [cx + level * ex + double * y * arm, cy + level * ey - double * x * arm, h + double * w * arm - heights[n]],
        [along + double * y * ey, aside - double * (arm + x * ey), double * (w * ey - (x * arm) / w)],
        [aside + double * (arm - y * ex), -along + double * x * ex, -double * (w * ex + (y * arm) / w)],
      ];
    });
  }

  // Half the square that each rod misses its own by at (h, x, y), and how that changes by h, x and y.
  equations(state, heights) {
    return this.rods(state, heights).map(([way, byX, byY]) => [
      (dot(way, way) - this.length * this.length) / 2,
      way[2],
      dot(way, byX),
      dot(way, byY),
    ]);
  }

  /** Return [h, x, y] where the way from home to heights [m] ends, and the share of it that is gone, up to 1. */
  reached(heights) {
    // A shift of all three carriages is one of the table: the way is that of their differences.
    const middle = (heights[0] + heights[1] + heights[2]) / 3;
    const apart = heights.map((z) => z - middle);
    const at = ([h, x, y]) => [h + middle, x, y];
    let state = [this.home, 0, 0];
    let gone = 0;
    let step = 1;
    while (gone < 1) {
      // The table's rates on the way: each carriage pushes by its slope upwards.
      const rows = this.equations(state, apart.map((z) => gone * z));
      const rates = solved(rows, rows.map((row, n) => row[1] * apart[n]));
      const pace = Math.max(Math.hypot(rates[1], rates[2]), SLIGHT);
      step = Math.min(step, STEP / pace);
      let found = null;
      let halved = false;
      let share = gone;
      while (found === null) {
        if (!(step >= SHORTEST)) return [at(state), gone];
        step = Math.min(step, 1 - gone);
        share = step === 1 - gone ? 1 : gone + step;
        const most = CORRECTED * pace * step + SLIGHT;
        const there = apart.map((z) => share * z);
        found = this.corrected(moved(state, rates, step), there, most, share === 1 ? FINE : ROUGH);
        if (found === null) {
          halved = true;
          step /= 2;
        }
      }
      state = found;
      gone = share;
      step *= halved ? 0.5 : 2; // close to a singular position the next one must be shorter, too
    }
    return [at(state), gone];
  }

  // The solution near a state by Newton's method, or null: farther than `most` from it, or beyond upright.
  corrected(start, heights, most, enough) {
    let state = start;
    for (let n = 0; n < NEWTONS; n += 1) {
      if (!(state[1] ** 2 + state[2] ** 2 < UPRIGHT)) return null;
      const rows = this.equations(state, heights);
      const change = solved(rows, rows.map((row) => -row[0]));
      const size = Math.hypot(change[1], change[2]);
      if (n === 0 && size > most) return null;
      state = moved(state, change, 1);
      if (Math.max(size, Math.abs(change[0])) < enough) return state;
    }
    return null;
  }
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const moved = (state, change, share) => state.map((value, n) => value + share * change[n]);

/** Return the change of (h, x, y) that changes three equations by wanted values; infinite where it is singular. */
function solved([[, a0, b0, c0], [, a1, b1, c1], [, a2, b2, c2]], [f0, f1, f2]) {
  const k0 = b1 * c2 - b2 * c1;
  const k1 = b2 * c0 - b0 * c2;
  const k2 = b0 * c1 - b1 * c0;
  const det = a0 * k0 + a1 * k1 + a2 * k2;
  if (det === 0) return [Infinity, Infinity, Infinity];
  const h = f0 * k0 + f1 * k1 + f2 * k2;
  const x = f0 * (a2 * c1 - a1 * c2) + f1 * (a0 * c2 - a2 * c0) + f2 * (a1 * c0 - a0 * c1);
  const y = f0 * (a1 * b2 - a2 * b1) + f1 * (a2 * b0 - a0 * b2) + f2 * (a0 * b1 - a1 * b0);
  return [h / det, x / det, y / det];
}
