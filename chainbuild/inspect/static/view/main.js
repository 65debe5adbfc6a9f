// Starts the page.
import { Page } from "cb/page";
import { contractOf } from "cb/contract";

const data = JSON.parse(document.getElementById("page-data").textContent);
const page = new Page(data, document.getElementById("pane"));
page.setAxes(page.axes, "start");
page.machine.fit();
window.chainbuild = contractOf(page);
