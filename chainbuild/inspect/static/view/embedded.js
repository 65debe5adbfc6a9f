// A page inside another window, as in the cell of a notebook: both keep the same axis values, and the last one wins.
// Messages: {chainbuild: "ready"} and {chainbuild: "axes", axes} go out, {chainbuild: "axes", axes} comes in.

/** Let the window around the page move the machine, and tell it where the machine stands. */
export function startEmbedded(page) {
  const host = window.parent;
  if (!page.data.embedded || host === window) return;
  // The origin of a notebook is its server's: any. Only the window that holds this one is spoken to and listened to.
  const tell = (message) => host.postMessage(message, "*");
  const hand = { pressed: false, moves: false, waiting: null };
  const take = (axes) => page.setAxes(axes, "host");
  window.addEventListener("message", ({ source, data }) => {
    if (source !== host) return;
    const axes = axesOf(data, page.axes.length);
    if (axes === null) return;
    // Whoever drags is not jerked back: what comes meanwhile counts only if nothing is moved after it.
    if (hand.moves) hand.waiting = axes;
    else take(axes);
  });
  page.onChange((_, cause) => {
    if (cause === "host" || cause === "search") return;
    hand.moves = hand.pressed;
    hand.waiting = null;
    tell({ chainbuild: "axes", axes: page.axes.slice() });
  });
  const release = () => {
    const { waiting } = hand;
    Object.assign(hand, { pressed: false, moves: false, waiting: null });
    if (waiting) take(waiting);
  };
  window.addEventListener("pointerdown", () => { hand.pressed = true; }, true);
  ["pointerup", "pointercancel", "blur"].forEach((name) => window.addEventListener(name, release));
  startWheel(page.machine.viewer.controls);
  tell({ chainbuild: "ready" });
}

/** Let the wheel scroll what is around the page until the page is clicked, and again when it is left. */
function startWheel(controls) {
  controls.enableZoom = false;
  window.addEventListener("pointerdown", () => { controls.enableZoom = true; }, true);
  window.addEventListener("blur", () => { controls.enableZoom = false; });
}

/** Return the axis values of a message, or null where it has none for so many axes. */
function axesOf(data, count) {
  const axes = data instanceof Object && data.chainbuild === "axes" ? data.axes : null;
  return Array.isArray(axes) && axes.length === count && axes.every(Number.isFinite) ? axes : null;
}
