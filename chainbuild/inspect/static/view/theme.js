// Dark or light: as the system has it, until the switch says otherwise.

const GRID = { light: 0x9eabb8, dark: 0x4d5a66 };

/** Let a button switch between dark and light. */
export function startTheme(page, button) {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const show = () => {
    button.textContent = dark() ? "Light" : "Dark";
    page.machine.node("grid/<object>").material.color.setHex(dark() ? GRID.dark : GRID.light);
    page.machine.viewer.set_dirty();
  };
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    show();
  });
  system.addEventListener("change", show);
  page.onModel(show);
  show();
}
