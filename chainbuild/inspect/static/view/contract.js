// What others may call from outside: window.chainbuild.
import { displayed } from "cb/display";
import { measure } from "cb/singular";
import { solveDisplayed } from "cb/typed";

/** Return the functions that drive the page from outside; poses are 16 numbers row by row, in metres. */
export function contractOf(page) {
  return {
    ready: Promise.resolve(),
    axes: () => page.axes.slice(),
    set: (axes) => page.setAxes(axes),
    fk: (axes) => page.chain.fk(axes),
    display: (axes) => displayed(page.chain, axes),
    drives: (axes) => page.limits.driveValues(axes),
    ik: (T, start) => {
      const { status, axes, branches } = page.solver.solve(T, start || page.axes);
      return { status, axes, branches };
    },
    ikDisplayed: (shown, start) => {
      const { status, axes, branches } = solveDisplayed(page.solver, shown, start || page.axes);
      return { status, axes, branches };
    },
    singular: (axes) => measure(page.chain, axes),
    violated: (axes) => page.limits.violated(axes),
    goTo: (T) => page.setPose(T),
    get ghosts() {
      return page.status.family ? 0 : Math.max(page.status.branches.length - 1, 0);
    },
    drag: (T) => page.drag(T),
    drawn: (name) => page.machine.drawn(name),
    drawnLength: (n) => page.machine.drawnLength(n),
    drawnFurther: (name, link) => {
      const one = (page.further || []).find((other) => other.name === name);
      return one && one.root.visible ? one.drawn(link) : null;
    },
    get lit() {
      return page.lit || { touching: [], moved: [] };
    },
    get frames() {
      return page.machine.frames;
    },
  };
}
