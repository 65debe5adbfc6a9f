// Starts the page.
import { contractOf } from "cb/contract";
import { startGhosts } from "cb/ghosts";
import { startGizmo } from "cb/gizmo";
import { axesOfHash, startHash } from "cb/hash";
import { startKeyboard } from "cb/keyboard";
import { startLabels } from "cb/labels";
import { Page } from "cb/page";
import { startPanel } from "cb/panel";
import { startPlayback } from "cb/playback";
import { startTheme } from "cb/theme";
import { startTools } from "cb/tools";

const data = JSON.parse(document.getElementById("page-data").textContent);
const page = new Page(data, document.getElementById("pane"));
const ghosts = startGhosts(page);
startTheme(page, document.getElementById("theme"));
startPanel(page, ghosts);
startTools(page, document.getElementById("tools"), ghosts);
startGizmo(page, document.getElementById("tools"));
startLabels(page, document.getElementById("labels"), document.getElementById("tools"));
startKeyboard(page, document.getElementById("axes"));
page.setAxes(axesOfHash(page.axes.length) || page.axes, "start");
page.machine.fit();
startPlayback(page.forPlayback(document.getElementById("playback")));
startHash(page);
page.searchWhenIdle();
window.chainbuild = contractOf(page);
