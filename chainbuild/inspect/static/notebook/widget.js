// The widget of a notebook: the page in a frame, and the same axis values in the page, in other cells and in Python.

const PATIENCE = 20000; // milliseconds until a page that does not start is said to be missing
const HUGE = 1e9; // mm and degrees: Python refuses such axis values
const MISSING = "This notebook does not let the page of the machine run. `chainbuild inspect --export` writes it as a file.";

/** Show the page; the function that is returned ends it. */
async function render({ model, el }) {
  const frame = document.createElement("iframe");
  // A frame without an origin: whatever the page does, it reaches nothing of the notebook and its server.
  frame.setAttribute("sandbox", "allow-scripts");
  frame.title = model.get("_title");
  Object.assign(frame.style, { display: "block", width: "100%", height: `${model.get("_height")}px`, border: "0" });
  frame.style.colorScheme = scheme();
  const note = document.createElement("p");
  const timer = setTimeout(() => { note.textContent = MISSING; }, PATIENCE);
  let shown = null; // axis values that the page has; null until it listens
  const show = () => {
    const axes = model.get("axes");
    if (shown === null || same(shown, axes)) return;
    shown = axes;
    // A frame without an origin has none that could be named.
    frame.contentWindow.postMessage({ chainbuild: "axes", axes }, "*");
  };
  const listen = ({ source, data }) => {
    if (source !== frame.contentWindow || !(data instanceof Object)) return;
    if (data.chainbuild === "ready") {
      // Also a page that was loaded anew, as where its cell was moved.
      clearTimeout(timer);
      note.textContent = "";
      shown = [];
      show();
    } else if (data.chainbuild === "axes" && fits(data.axes, model.get("axes").length)) {
      shown = data.axes;
      model.set("axes", data.axes);
      model.save_changes();
    }
  };
  window.addEventListener("message", listen);
  model.on("change:axes", show);
  frame.srcdoc = await unpacked(model.get("_page"));
  el.append(frame, note);
  return () => {
    clearTimeout(timer);
    window.removeEventListener("message", listen);
    model.off("change:axes", show);
  };
}

/** Return whether the notebook is "dark" or "light"; nothing where it does not say: the page does as the system. */
function scheme() {
  const { jpThemeLight } = document.body.dataset;
  return { true: "light", false: "dark" }[jpThemeLight] || "";
}

/** Return the text of packed bytes. */
function unpacked(bytes) {
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

function fits(axes, count) {
  const within = (value) => Number.isFinite(value) && Math.abs(value) < HUGE;
  return Array.isArray(axes) && axes.length === count && axes.every(within);
}

const same = (one, other) => one.length === other.length && one.every((value, n) => value === other[n]);

export default { render };
