// Links in colours of their own: red where bodies touch, lit where a datum moves them.

const COLOURS = { touching: 0xd4281c, moved: 0x00b7e6 };
const SHARE = 0.55; // of the colour that a body takes on

/** Return what colours links: `highlights.show("touching" | "moved", names)`. */
export function startHighlights(page) {
  const { machine } = page;
  const names = { touching: new Set(), moved: new Set() };
  const paint = () => {
    page.chain.data.links.forEach((link, n) => {
      const kind = names.touching.has(link) ? "touching" : names.moved.has(link) ? "moved" : null;
      machine.bodies(n).forEach((body) => body.traverse((part) => {
        if (!part.isMesh || !part.material.emissive) return;
        part.userData.colour = part.userData.colour ?? part.material.color.getHex();
        part.material.color.setHex(part.userData.colour);
        if (kind) part.material.color.lerp(new machine.three.Color(COLOURS[kind]), SHARE);
      }));
    });
    machine.viewer.set_dirty();
  };
  page.onModel(paint);
  return {
    show: (kind, links) => {
      const same = links.length === names[kind].size && links.every((one) => names[kind].has(one));
      if (same) return;
      names[kind] = new Set(links);
      page.lit = { touching: [...names.touching], moved: [...names.moved] };
      paint();
    },
  };
}
