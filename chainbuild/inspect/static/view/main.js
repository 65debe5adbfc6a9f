// Starts the page.
import { contractOf } from "cb/contract";
import { startDimensions } from "cb/dimensions";
import { startEmbedded } from "cb/embedded";
import { startGhosts } from "cb/ghosts";
import { startGizmo } from "cb/gizmo";
import { axesOfHash, hashIsForeign, startHash } from "cb/hash";
import { startKeyboard } from "cb/keyboard";
import { startLabels } from "cb/labels";
import { startLive } from "cb/live";
import { Page } from "cb/page";
import { startPanel } from "cb/panel";
import { startPlayback } from "cb/playback";
import { startTheme } from "cb/theme";
import { startTools } from "cb/tools";

// The viewer holds a script for workers that takes any message for a frame of a film, and sends itself another, for ever.
window.onmessage = null;
const data = JSON.parse(document.getElementById("page-data").textContent);
const page = new Page(data, document.getElementById("pane"));
const ghosts = startGhosts(page);
startTheme(page, document.getElementById("theme"));
startPanel(page, ghosts);
startTools(page, document.getElementById("tools"), ghosts);
startGizmo(page, document.getElementById("tools"));
startDimensions(page, document.getElementById("tools"));
startLabels(page, document.getElementById("labels"), document.getElementById("tools"));
startKeyboard(page, document.getElementById("axes"));
page.setAxes(axesOfHash(page.axes.length) || page.axes, "start");
if (hashIsForeign(page.axes.length)) page.tell(`The address does not hold ${page.axes.length} axis values: it is not used.`);
page.machine.fit();
const player = startPlayback(page.forPlayback(document.getElementById("playback")));
// Other data move no axis: the table goes on.
page.onChange((_, cause) => { if (player && !["playback", "search", "model"].includes(cause)) player.leave(); });
startHash(page);
startEmbedded(page);
page.searchWhenIdle();
startLive(page, axesOfHash(page.axes.length) !== null);
window.chainbuild = contractOf(page);
