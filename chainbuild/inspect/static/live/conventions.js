// Conventions that are switched: what the manuals leave open, chosen otherwise.
import { element } from "cb/elements";

/** Offer the kinematics of the file, where there are several. */
export function startKinematics(page, link) {
  const { kinematics } = page.data.live;
  if (kinematics.length < 2) return;
  const select = element("select", { id: "kinematic", "aria-label": "Kinematic of the file" });
  kinematics.forEach(({ n, text, shown }) => {
    const option = element("option", { value: String(n) }, text);
    option.selected = shown;
    select.append(option);
  });
  select.addEventListener("input", () => link.send("kinematic", Number(select.value)));
  document.querySelector("h1").after(select);
}

/** Put choices into the panel's list of conventions; return what does it again for another model, and what undoes a choice. */
export function startConventions(page, link) {
  const fill = () => {
    const { conventions } = page.data.live;
    conventions.forEach((one) => {
      const term = [...document.querySelectorAll("dt[data-convention]")].find((dt) => dt.dataset.convention === one.name);
      if (!term) return;
      const select = element("select", { "data-convention": one.name, "aria-label": one.name, title: one.question });
      one.choices.forEach((choice) => {
        const option = element("option", { value: choice }, choice);
        option.selected = choice === one.choice;
        select.append(option);
      });
      select.addEventListener("input", () => link.send("convention", { name: one.name, choice: select.value }));
      term.removeAttribute("data-convention");
      term.replaceChildren(`${one.name} `, select);
    });
  };
  const renew = () => {
    const { html } = page.data.live;
    if (!html) return;
    Object.entries(html).forEach(([name, text]) => {
      const old = document.getElementById(name);
      const open = old.open;
      // Made by chainbuild, which has escaped every text of the machine data in it.
      old.outerHTML = text;
      document.getElementById(name).open = open;
    });
  };
  fill();
  const again = () => {
    const chosen = document.activeElement instanceof HTMLSelectElement ? document.activeElement.dataset.convention : null;
    renew();
    fill();
    if (chosen) document.querySelector(`select[data-convention="${CSS.escape(chosen)}"]`)?.focus();
  };
  /** Show what is chosen, where a choice was refused. */
  const undo = () => page.data.live.conventions.forEach(({ name, choice }) => {
    const select = document.querySelector(`select[data-convention="${CSS.escape(name)}"]`);
    if (select) select.value = choice;
  });
  return { again, undo };
}
