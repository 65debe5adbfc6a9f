// The panel beside the picture.
import { startBars } from "cb/bars";
import { startChooser } from "cb/chooser";
import { startNamed } from "cb/named";
import { startPose } from "cb/pose";
import { startRows } from "cb/rows";
import { startState } from "cb/state";

/** Start every section of the panel. */
export function startPanel(page, ghosts) {
  const section = (name) => document.getElementById(name);
  startRows(page, section("axes"));
  startPose(page, section("pose"));
  startState(page, section("state"));
  startBars(page, section("bars"));
  startNamed(page, section("presets"));
  startChooser(page, section("solutions"), ghosts);
}
