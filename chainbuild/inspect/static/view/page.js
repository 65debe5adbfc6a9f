// The state of the page: axis values, what follows from them, and who wants to be told.
import { Chain } from "cb/chain";
import { displayed } from "cb/display";
import { Limits } from "cb/limits";
import { Machine } from "cb/machine";
import { measure } from "cb/singular";
import { Solver } from "cb/ik";
import { solveDisplayed } from "cb/typed";

const EXACT = 1e-6; // smallest singular value below which a position is singular
const IDLE = 250; // milliseconds at rest before other solutions are looked for

export class Page {
  constructor(data, pane) {
    this.data = data;
    this.chain = new Chain(data.chain);
    this.limits = new Limits(this.chain);
    this.solver = new Solver(this.chain, this.limits);
    this.machine = new Machine(data, this.chain, pane);
    this.listeners = [];
    this.modelListeners = [];
    this.axes = data.rest.slice();
    this.status = { status: "ok", words: "", branches: [], family: false };
  }

  /** Call a function after every change: with the page and what caused it. */
  onChange(listener) {
    this.listeners.push(listener);
  }

  /** Call a function whenever another model has taken the place of this one. */
  onModel(listener) {
    this.modelListeners.push(listener);
  }

  /** Show a robot of the same structure with other data; the axes stay where they are. */
  swap(data) {
    Object.assign(this.data, data);
    this.chain = new Chain(this.data.chain);
    this.limits = new Limits(this.chain);
    this.solver = new Solver(this.chain, this.limits);
    this.machine.rebuild(this.chain);
    this.modelListeners.forEach((listener) => listener());
    this.setAxes(this.axes, "model");
  }

  /** Show solutions that somebody else has found for the place where the machine stands. */
  offer(branches) {
    this.status = { ...this.status, branches, searched: true };
    if (this.status.status === "ok" && !this.status.told) this.status.words = wordsOf(this.status, []);
    this.changed("search");
  }

  /** Say something beside the status, until the machine moves. */
  tell(words) {
    this.status.words = words;
    this.status.told = true;
    this.changed("search");
  }

  /** Move the machine; values outside the limits are shown as such. */
  setAxes(axes, cause = "axes") {
    this.axes = axes.slice();
    const violated = this.limits.violated(axes);
    const pose = this.chain.fk(axes);
    const status = pose === null ? "unreachable" : violated.length ? "limits" : "ok";
    const words = pose === null ? "The kinematic has no pose here." : outsideWords(violated);
    this.status = { status, words, violated, branches: [], family: false, searched: false };
    this.changed(cause);
  }

  /** Take the solution of a pose: the machine goes to the nearest branch, or as near as it can. */
  take(found, cause) {
    this.axes = found.axes.slice();
    const violated = this.limits.violated(this.axes);
    this.status = { ...found, violated, words: wordsOf(found, violated), searched: true };
    this.changed(cause);
  }

  /** Solve for a pose as the controller displays it, for the solution nearest to axis values. */
  setDisplayed(shown, start = this.axes) {
    this.take(solveDisplayed(this.solver, shown, start), "pose");
  }

  /** Solve for the tool in the workpiece frame. */
  setPose(T) {
    this.take(this.solver.solve(T, this.axes), "pose");
  }

  /** Follow a dragged pose: the machine moves as far as its limits permit. */
  drag(T) {
    const { axes, met } = this.solver.approach(T, this.axes);
    const violated = this.limits.violated(axes);
    const branches = this.followed(T);
    this.axes = axes;
    const status = met ? "ok" : this.solver.reaches(T, axes) ? "limits" : "unreachable";
    const found = { status: met && violated.length ? "limits" : status, branches, family: this.status.family };
    this.status = { ...found, violated, words: wordsOf(found, violated), searched: this.status.searched };
    this.changed("drag");
  }

  followed(T) {
    return this.status.branches.map((axes) => this.solver.follow(T, axes)).filter((axes) => axes !== null);
  }

  /** Look for the other solutions of the place where the machine stands; it does not move. */
  search() {
    const T = this.chain.fk(this.axes);
    if (T === null || this.status.branches.length) return;
    const { branches, family } = this.solver.solve(T, this.axes);
    this.status = { ...this.status, branches, family, searched: true };
    if (this.status.status === "ok" && !this.status.told) this.status.words = wordsOf(this.status, []);
    this.changed("search");
  }

  /** Look for the other solutions whenever the machine has rested for a moment. */
  searchWhenIdle() {
    let timer = null;
    const wait = () => {
      window.clearTimeout(timer);
      timer = window.setTimeout(() => this.search(), IDLE);
    };
    this.onChange((_, cause) => { if (!["search", "pose", "branch", "drag"].includes(cause)) wait(); });
    wait();
  }

  /** Go to one of the solutions; the others stay. */
  choose(k) {
    const { branches, family } = this.status;
    if (!branches[k]) return;
    this.axes = branches[k].slice();
    this.status = { status: "ok", violated: [], branches, family, words: "", searched: true };
    this.status.words = wordsOf(this.status, []);
    this.changed("branch");
  }

  /** Return what a playback of a table needs of the page, for a section of the panel. */
  forPlayback(root) {
    root.hidden = !this.data.playback;
    return {
      root,
      data: this.data,
      chain: this.chain,
      three: this.machine.three,
      inWorkpiece: this.machine.inWorkpiece(),
      setAxes: (axes) => this.setAxes(axes, "playback"),
      redraw: () => this.machine.viewer.set_dirty(),
    };
  }

  changed(cause) {
    this.machine.move(this.axes);
    this.measures = measure(this.chain, this.axes);
    this.status.singular = this.measures !== null && this.measures.smallest < EXACT;
    this.listeners.forEach((listener) => listener(this, cause));
  }

  displayed() {
    return displayed(this.chain, this.axes);
  }
}

function outsideWords(violated) {
  return violated.length ? `Outside the limits of ${violated.join(", ")}.` : "";
}

function wordsOf({ status, branches, family }, violated) {
  if (status === "ok") {
    if (family) return "One of infinitely many solutions: more axes move than the pose determines.";
    return branches.length > 1 ? `${branches.length} solutions.` : "";
  }
  if (status === "limits") return outsideWords(violated) || "Reached only outside the limits.";
  return status === "unreachable" ? "Out of reach." : "No solution found from here.";
}
