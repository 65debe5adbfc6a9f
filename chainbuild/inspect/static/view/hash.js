// The address keeps the pose: #axes=… names it, and a page that is opened with it starts there.

const HUGE = 1e6; // mm and degrees: no machine has so much
const PAUSE = 300; // milliseconds between two changes: browsers refuse hundreds in half a minute

/** Return the axis values in the address, or null where it holds none for so many axes. */
export function axesOfHash(count) {
  const found = /^#axes=(.*)$/.exec(window.location.hash);
  const parts = found ? found[1].split(",") : [];
  const values = parts.map((part) => (/^-?\d+(\.\d+)?(e-?\d+)?$/i.test(part) ? Number(part) : NaN));
  return values.length === count && values.every((value) => Math.abs(value) < HUGE) ? values : null;
}

/** Tell whether the address names axis values that are not those of this machine. */
export const hashIsForeign = (count) => window.location.hash.startsWith("#axes=") && axesOfHash(count) === null;

/** Keep the address up to date, and follow it where somebody else changes it. */
export function startHash(page) {
  let timer = null;
  const write = () => {
    timer = null;
    const hash = `#axes=${page.axes.map((v) => Number(v.toFixed(9))).join(",")}`;
    try {
      if (hash !== window.location.hash) window.history.replaceState(null, "", hash);
    } catch (refused) {
      // A page inside another one, as in a notebook, has no address of its own.
    }
  };
  page.onChange((_, cause) => {
    if (cause !== "search" && timer === null) timer = window.setTimeout(write, PAUSE);
  });
  window.addEventListener("hashchange", () => {
    const axes = axesOfHash(page.axes.length);
    if (axes) page.setAxes(axes, "hash");
  });
}
