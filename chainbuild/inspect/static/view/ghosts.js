// Ghosts: the other solutions of the pose, of which only the links are drawn that stand elsewhere.
import { linkBodies } from "cb/machine";

const FAINT = 0.12;
const STRONG = 0.5;
const APART = 1e-4; // metres and parts of a direction: links nearer than that stand in the same place
const MOST = 12; // ghosts drawn at once; a crowd tells nothing

/** Draw the solutions in the status of the page; return what makes one of them strong. */
export function startGhosts(page) {
  const { machine } = page;
  const { three } = machine;
  const material = (opacity) => new three.MeshLambertMaterial({
    color: 0x5b7fa6, transparent: true, opacity, depthWrite: false,
    polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2, // behind bodies in the same place
  });
  const [faint, strong] = [material(FAINT), material(STRONG)];
  const group = new three.Group();
  machine.root.add(group);
  const ghosts = [];
  let wanted = null;
  const ghost = () => {
    const links = machine.links.map((_, n) => {
      const copy = new three.Group();
      copy.matrixAutoUpdate = false;
      linkBodies(machine, n).forEach((body) => copy.add(copied(body, faint)));
      return copy;
    });
    const whole = new three.Group();
    links.forEach((link) => whole.add(link));
    group.add(whole);
    return { whole, links };
  };
  const dress = () => ghosts.forEach(({ whole }, k) => {
    whole.traverse((part) => { if (part.isMesh) part.material = k === wanted ? strong : faint; });
  });
  // Their bodies are those of the model that they were copied from.
  page.onModel(() => {
    group.clear();
    ghosts.length = 0;
  });
  page.onChange(() => {
    const branches = page.status.family ? [] : page.status.branches.slice(0, MOST);
    const here = branches.length ? page.chain.placements(page.axes) : [];
    while (ghosts.length < branches.length) ghosts.push(ghost());
    ghosts.forEach(({ whole, links }, k) => {
      whole.visible = k < branches.length;
      if (!whole.visible) return;
      const there = page.chain.placements(branches[k]);
      links.forEach((link, n) => {
        link.visible = there[n].some((v, m) => Math.abs(v - here[n][m]) > APART);
        link.matrix.set(...there[n]);
        link.matrixWorldNeedsUpdate = true;
      });
    });
    dress();
    machine.viewer.set_dirty();
  });
  return {
    group,
    emphasise: (k) => {
      wanted = k;
      dress();
      machine.viewer.set_dirty();
    },
  };
}

/** Return a copy of a body in one material; its shape is shared. */
function copied(body, material) {
  const copy = body.clone();
  copy.traverse((part) => { if (part.isMesh) part.material = material; });
  return copy;
}
