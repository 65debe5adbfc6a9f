// A machine file that is dropped on the page is shown in place of the machine.

const LARGEST = 16 * 1024 * 1024; // bytes that Python takes

/** Take files that are dropped; `say` tells what became of them. */
export function startDrop(target, say) {
  target.addEventListener("dragover", (event) => {
    if (![...event.dataTransfer.types].includes("Files")) return;
    event.preventDefault();
    document.documentElement.dataset.drop = "over";
  });
  target.addEventListener("dragleave", () => { delete document.documentElement.dataset.drop; });
  target.addEventListener("drop", (event) => {
    delete document.documentElement.dataset.drop;
    const [file] = event.dataTransfer.files;
    if (!file) return;
    event.preventDefault();
    upload(file, say);
  });
}

async function upload(file, say) {
  if (file.size > LARGEST) {
    say(`${file.name} is too large for a machine file: at most 16 MB are taken.`);
    return;
  }
  say(`Reading ${file.name} …`);
  try {
    const answer = await fetch(`/drop${window.location.search}`, {
      method: "POST", body: file, headers: { "X-File-Name": encodeURIComponent(file.name) },
    });
    // Where it is shown, the session greets the page anew.
    if (!answer.ok) say(`${file.name} was refused (${answer.status}).`);
    else say((await answer.json()).refused || "");
  } catch (lost) {
    say(`${file.name} was not taken: Python does not answer.`);
  }
}
