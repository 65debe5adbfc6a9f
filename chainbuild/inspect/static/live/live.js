// A page with Python behind it: what it does beyond an exported one.
import { startCollisions } from "cb/collisions";
import { startConventions, startKinematics } from "cb/conventions";
import { startDrop } from "cb/drop";
import { element } from "cb/elements";
import { startFurther } from "cb/further";
import { startHighlights } from "cb/highlights";
import { Link } from "cb/link";
import { startParameters } from "cb/parameters";
import { startSection } from "cb/section";

const OWN = new Set(["axes", "pose", "drag", "branch", "key", "preset", "hash", "playback"]); // moved here, not elsewhere
const OF_PYTHON = "#parameters, #workspace, #kinematic, select[data-convention]"; // do nothing while it does not answer
const IDLE = 250; // milliseconds at rest before Python is asked for every solution

/** Connect the page to Python, if it was served by it; `opened` is true where the address names a pose. */
export function startLive(page, opened) {
  const { live } = page.data;
  if (!live) return;
  const before = document.querySelector(".keys");
  const section = (name, title) => {
    const root = element("section", { id: name }, element("h2", {}, title));
    before.before(root);
    return root;
  };
  const state = { moved: opened, hello: false };
  const highlights = startHighlights(page);
  const tell = element("p", { id: "link", role: "status" });
  document.getElementById("state").append(tell);
  const say = (words) => { tell.textContent = words; };
  let [parameters, showing] = [null, null];
  const link = new Link((kind, content) => takers[kind] && takers[kind](content), (open) => {
    document.documentElement.dataset.link = open ? "open" : "lost";
    document.querySelectorAll(OF_PYTHON).forEach((one) => { one.inert = !open; });
    if (parameters) parameters.lost();
    if (open && showing) showing.again();
    say(open ? "" : "Python does not answer: the page goes on by itself, and tries again.");
  });
  parameters = startParameters(page, link, section("parameters", "Machine data"), highlights);
  const conventions = startConventions(page, link);
  startFurther(page, section("further", "Beside the machine"));
  const collisions = startCollisions(page, section("collisions", "Collisions"), highlights);
  showing = startSection(page, link, section("workspace", "Workspace section"));
  startDrop(document.body, say);
  startKinematics(page, link);
  const takers = {
    hello: (hello) => greet(page, link, state, hello),
    axes: ({ axes }) => { if (differs(axes, page.axes)) page.setAxes(axes, "remote"); },
    contacts: collisions,
    model: (model) => {
      if (model.live.structure !== page.data.live.structure) {
        startAnew(page);
        return;
      }
      page.swap({ ...model, live: { ...page.data.live, ...model.live } });
      parameters.took();
      conventions.again();
      link.send("presets");
    },
    presets: (presets) => page.offerPoses(presets),
    refused: (told) => {
      if (told.key !== null && parameters.refused(told)) return;
      conventions.undo();
      say(told.text);
    },
    moves: (found) => parameters.moves(found),
    section: showing.take,
  };
  page.onChange((_, cause) => {
    if (!OWN.has(cause)) return;
    state.moved = true;
    if (link.open) say("");
    link.post("axes", page.axes);
  });
  askWhenIdle(page, link);
}

/** Return whether axis values are others of the same machine. */
const differs = (axes, own) => axes.length === own.length && axes.some((value, n) => value !== own[n]);

/** Meet the session: it keeps the state; a new one of the same machine takes that of the page. */
function greet(page, link, state, { session, machine, number, axes }) {
  const { live } = page.data;
  if (machine !== live.machine) {
    startAnew(page, false);
    return;
  }
  if (session !== live.session) {
    live.session = session;
    link.send("restore", { values: live.values, choices: live.choices, axes: page.axes });
  } else {
    if (number !== live.number) link.send("model");
    if (state.moved) link.post("axes", page.axes);
    else if (differs(axes, page.axes)) page.setAxes(axes, "remote");
  }
  state.moved = false;
}

/** Load the page anew: another machine, or one with other axes. */
function startAnew(page, keep = true) {
  const { pathname, search } = window.location;
  const hash = keep ? `#axes=${page.axes.join(",")}` : "";
  window.history.replaceState(null, "", `${pathname}${search}${hash}`);
  window.location.reload();
}

/** Let Python look for every solution when the machine has rested for a moment: it has the closed forms. */
function askWhenIdle(page, link) {
  let timer = null;
  page.onChange((_, cause) => {
    if (cause === "search") return;
    window.clearTimeout(timer);
    if (cause === "branch") return; // the list stays in its order, so that one may be clicked after the other
    timer = window.setTimeout(() => {
      const { axes, status } = page;
      const T = page.chain.fk(axes);
      if (T === null || status.family || !["ok", "limits"].includes(status.status)) return;
      link.ask({ ik_all: T, start: axes }).then(({ ik_all: branches }) => {
        // The machine may have moved on, or stand where a pose out of reach has left it.
        if (branches && page.axes === axes && !page.status.family) page.offer(branches);
      }, () => {}); // without Python the page looks for them itself
    }, IDLE);
  });
}
