// What colours, widths and signs mean; and the elements that it is made of.

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && key !== "role" && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function icon(path, name = "") {
  const template = document.createElement("template"); // its parser knows the namespace
  template.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true" class="${name}"><path d="${path}"></path></svg>`;
  return template.content.firstChild;
}

function shapeOfEvent(kind) {
  const points = (run.shapes[kind] ?? run.shapes.clog).map(([u, v]) => `${12 + 8 * u} ${12 - 8 * v}`);
  return icon(`M${points.join("L")}z`, "event");
}

// Kinds of grains, how wide force chains are, and the colours of a view.
function legendOf(panes, view, name, chains) {
  const parts = [];
  const theme = run.themes[name];
  const count = [0, 0];
  for (const pane of panes) for (let k = 0; k < pane.count; k++) count[pane.nu[k] < 0 ? 1 : 0]++;
  ["regular", "auxetic"].forEach((kind, k) => {
    if (count[k]) parts.push(element("span", { className: "part" }, kindPicture(kind, view, name), word("kinds_" + kind)));
  });
  const bar = (title, top, unit, ramp, wedge) => {
    const picture = element("span", { className: wedge ? "ramp wedge" : "ramp" });
    picture.style.backgroundImage = `linear-gradient(to right, ${ramp.map(css).join(",")})`;
    const high = `${number(top, decimalsFor(top / 10))} ${unit}`.trim();
    parts.push(element("span", { className: "part" }, `${title}  0`, picture, high));
  };
  if (chains || view.onlyChains) {
    bar(word("chains"), run.tops.chains, "k R", view.valued ? [theme.text, theme.text] : theme.ramps.chains, true);
  }
  if (view.valued) bar(say(view.title), view.top, view.unit, theme.ramps[view.ramp], false);
  return parts;
}

// A grain as on the canvas.
function kindPicture(kind, view, theme) {
  const ratio = devicePixelRatio || 1;
  const canvas = element("canvas", { width: 24 * ratio, height: 24 * ratio, className: "kind" });
  canvas.setAttribute("aria-hidden", "true");
  const one = (value) => Float32Array.of(value);
  const pane = { count: 1, labels: [0], x: one(0), y: one(0), p: one(1), q1: one(0), q2: one(0), rest: one(1), spin: one(0), there: one(1), pointed: one(0), squeezed: one(0) };
  Object.assign(pane, { nu: one(kind === "auxetic" ? -1 : 1), bodies: [], handles: [], box: null, rubs: false, active: [[]] });
  const shown = view.valued ? run.views.find((each) => each.name === "kind") : view;
  const camera = { k: 11 * ratio, x: 12 * ratio, y: 12 * ratio };
  const scenery = new Scenery(canvas.getContext("2d"), pane, 0, camera, { theme, view: shown, chains: false, scale: ratio });
  scenery.line = 1.5 * ratio;
  scenery.grains();
  return canvas;
}
