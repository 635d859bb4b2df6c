// The grains of one packing at one moment. It draws what was recorded, nothing is computed anew.

const TURN = 2 * Math.PI;
const GOLDEN = 0.6180339887498949;

function mix(first, second, share) {
  const part = (shift) => Math.round(((first >> shift) & 255) + (((second >> shift) & 255) - ((first >> shift) & 255)) * share);
  return (part(16) << 16) | (part(8) << 8) | part(0);
}

const css = (colour) => "#" + colour.toString(16).padStart(6, "0");

// World to pixels: the bounds fit into the canvas with a margin.
function cameraFor(bounds, width, height, margin, scale) {
  const [x0, y0, x1, y1] = bounds;
  const k = scale ?? Math.min((width - 2 * margin) / (x1 - x0), (height - 2 * margin) / (y1 - y0));
  return { k, x: width / 2 - (k * (x0 + x1)) / 2, y: height / 2 + (k * (y0 + y1)) / 2 };
}

// Where else a thing is seen that reaches `reach` around (x, y) in a periodic cell; the place itself comes first.
function imagesOf(cell, x, y, reach) {
  const found = [[x, y]];
  if (!cell) return found;
  const rows = cell.high ? [-1, 0, 1] : [0];
  const columns = cell.wide ? [-2, -1, 0, 1, 2] : [0];
  for (const row of rows) {
    for (const column of columns) {
      if (!row && !column) continue;
      const ix = x + column * (cell.wide ? cell.width : 0) + (row ? row * (cell.shift % (cell.width || Infinity)) : 0);
      const iy = y + (row ? row * cell.height : 0);
      if (cell.wide && (ix + reach < 0 || ix - reach > cell.width)) continue;
      if (cell.high && (iy + reach < 0 || iy - reach > cell.height)) continue;
      found.push([ix, iy]);
    }
  }
  return found;
}

function cellAt(pane, moment) {
  if (!pane.box) return null;
  const [width, height, shift] = pane.box.size.subarray(3 * moment, 3 * moment + 3);
  return { wide: pane.box.wide, high: pane.box.high, width: pane.box.wide ? width : 0, height, shift };
}

class Grains {
  constructor(context, pane, moment, camera, look) {
    this.g = context;
    this.pane = pane;
    this.moment = moment;
    this.camera = camera;
    this.look = look; // theme, view, chains, scale [px]
    this.theme = run.themes[look.theme];
    this.cell = cellAt(pane, moment);
    this.line = Math.min(1.5 * look.scale, 0.14 * camera.k);
  }

  px(x) {
    return this.camera.x + this.camera.k * x;
  }

  py(y) {
    return this.camera.y - this.camera.k * y;
  }

  // Every grain that is there, once for each place where it is seen: [index into the series, x and y in pixels].
  places() {
    const { pane, moment } = this;
    const found = [];
    for (let grain = 0, k = moment * pane.count; grain < pane.count; grain++, k++) {
      if (!pane.there[k]) continue;
      const reach = pane.p[k] + Math.hypot(pane.q1[k], pane.q2[k]);
      for (const [x, y] of imagesOf(this.cell, pane.x[k], pane.y[k], reach)) found.push([k, this.px(x), this.py(y), grain]);
    }
    return found;
  }

  grains() {
    const { g, pane, look } = this;
    const places = this.places();
    const groups = new Map(); // by colour, so that each is filled at once
    for (const place of places) {
      const [fill, rim] = this.colours(place[0]);
      const key = fill * 0x1000000 + rim;
      if (!groups.has(key)) groups.set(key, [fill, rim, []]);
      groups.get(key)[2].push(place);
    }
    const made = look.view.made;
    for (const [fill, rim, some] of groups.values()) {
      this.discs(some, 0, rim); // two fillings are quicker than a filling and an outline
      this.discs(some, made ? -0.5 * this.line : -this.line, fill);
      if (made) this.holes(some, fill);
      if (pane.rubs) this.radii(made ? some.filter(([k]) => !(pane.nu[k] < 0)) : some, rim, made);
    }
    const pointed = places.filter(([k]) => pane.pointed[k]);
    if (pointed.length) {
      const path = new Path2D();
      for (const place of pointed) this.ellipse(path, place, -1.1 * this.line);
      g.strokeStyle = css(this.theme.event);
      g.lineWidth = 2.2 * this.line;
      g.stroke(path);
    }
    if (!made) this.signs(places);
  }

  discs(some, grow, colour) {
    this.g.fillStyle = css(colour);
    for (const place of some) {
      this.g.beginPath(); // an ellipse alone is drawn quickly, many in one path are not
      this.ellipse(this.g, place, grow);
      this.g.fill();
    }
  }

  // Fill and rim of a grain.
  colours(k) {
    const { pane, look, theme } = this;
    const { view } = look;
    if (view.valued) {
      const share = MEASURES[view.name](pane, k) / view.top;
      return [rampColour(theme.ramps[view.ramp], share), mix(theme.hairline, theme.text, 0.25)];
    }
    const recede = view.onlyChains ? 0.85 : 0;
    const kind = pane.nu[k] < 0 ? theme.auxetic : theme.regular;
    return [mix(kind, theme.ground, recede), mix(mix(kind, 0, 0.38), theme.ground, recede)];
  }

  ellipse(path, [k, x, y], grow) {
    const { pane, camera } = this;
    const q = Math.hypot(pane.q1[k], pane.q2[k]);
    const a = Math.max(camera.k * (pane.p[k] + q) + grow, 0.1);
    const b = Math.max(camera.k * (pane.p[k] - q) + grow, 0.1);
    const angle = -0.5 * Math.atan2(pane.q2[k], pane.q1[k]);
    if (path instanceof Path2D) path.moveTo(x + a * Math.cos(angle), y + a * Math.sin(angle));
    path.ellipse(x, y, a, b, angle, 0, TURN);
  }

  // From the grain's own frame, a unit disc turned by `turn`, to pixels: it is stretched as the grain is.
  frame(k, x, y, turn) {
    const { pane, camera } = this;
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    const [p, q1, q2] = [pane.p[k], pane.q1[k], pane.q2[k]];
    return (u, v) => {
      const [tu, tv] = [c * u - s * v, s * u + c * v];
      return [x + camera.k * ((p + q1) * tu + q2 * tv), y - camera.k * (q2 * tu + (p - q1) * tv)];
    };
  }

  // How far the hole of an auxetic grain is open: 1 at rest, 0 from where a real one has closed.
  openness(k) {
    const { pane } = this;
    const area = (pane.p[k] ** 2 - pane.q1[k] ** 2 - pane.q2[k] ** 2) / pane.rest[k] ** 2;
    return Math.min(Math.max((area - run.made.closed) / (1 - run.made.closed), 0), 1);
  }

  // The re-entrant sign of auxetic grains: a bow-tie that closes as they shrink.
  signs(places) {
    const { g, pane, camera } = this;
    g.fillStyle = css(this.theme.ground);
    for (const [k, x, y] of places) {
      const smallest = camera.k * (pane.p[k] - Math.hypot(pane.q1[k], pane.q2[k]));
      if (!(pane.nu[k] < 0) || smallest < 1.5) continue;
      const [opened, slit] = [this.openness(k), 0.55 / smallest];
      const [waist, end, h] = [Math.max(0.1 * opened, slit), Math.max(0.46 * opened, slit), 0.52];
      const at = this.frame(k, x, y, pane.spin[k]);
      g.beginPath();
      polygon(g, [[end, h], [waist, 0], [end, -h], [-end, -h], [-waist, 0], [-end, h]].map(([u, v]) => at(u, v)));
      g.fill();
    }
  }

  // Grains as they are made: rings, and discs with a re-entrant hole, a wedge from the rim, and a tooth that bars it.
  holes(some, fill) {
    const { g, pane, camera } = this;
    const { wall, tip, wing, notch, hinge, mouth, tooth } = run.made;
    const [open, bars] = [new Path2D(), new Path2D()];
    for (const place of some) {
      const [k, x, y, grain] = place;
      const stretch = Math.hypot(pane.q1[k], pane.q2[k]);
      const smallest = camera.k * (pane.p[k] - stretch);
      if (!(pane.nu[k] < 0)) {
        if (smallest > camera.k * wall * pane.rest[k]) this.ellipse(open, place, -camera.k * wall * pane.rest[k]);
        continue;
      }
      const opened = this.openness(k);
      const slit = 0.45 / smallest;
      const top = Math.min(notch[1] + (notch[0] - notch[1]) * opened, tip - 3 * slit);
      const wide = Math.max(mouth * opened, slit);
      const at = this.frame(k, x, y, pane.spin[k] + TURN * ((GOLDEN * pane.labels[grain]) % 1));
      polygon(open, [[0, tip], [wing[0], wing[1]], [0, top], [-wing[0], wing[1]]].map(([u, v]) => at(u, v)));
      polygon(open, [[0, top - hinge], [wide, -1.02], [-wide, -1.02]].map(([u, v]) => at(u, v)));
      if (smallest < 9 * this.look.scale) continue;
      const thick = (tooth.thick * pane.rest[k]) / pane.p[k];
      const end = mouth * opened;
      polygon(open, rimStrip(-tooth.long - 0.08, 0, thick + tooth.gap).map(([u, v]) => at(u, v)));
      polygon(bars, rimStrip(end - tooth.long, end + 0.15, thick).map(([u, v]) => at(u, v)));
    }
    g.fillStyle = css(this.theme.ground);
    g.fill(open);
    g.fillStyle = css(fill);
    g.fill(bars);
  }

  // A radius that turns with each grain.
  radii(some, rim, made) {
    const { g, pane, camera } = this;
    const path = new Path2D();
    for (const [k, x, y] of some) {
      if (camera.k * pane.p[k] < 5.5 * this.look.scale) continue;
      const at = this.frame(k, x, y, pane.spin[k]);
      const start = made ? 1 - 0.8 * run.made.wall : pane.nu[k] < 0 ? 0.55 : 0;
      path.moveTo(...at(start, 0));
      path.lineTo(...at(0.9, 0));
    }
    g.strokeStyle = css(rim);
    g.lineWidth = 1.6 * this.look.scale;
    g.stroke(path);
  }

  // A cross on every grain that is squeezed further than a real one could be.
  crosses() {
    const { g, pane, look, camera } = this;
    const path = new Path2D();
    for (const [k, x, y] of this.places()) {
      if (!pane.squeezed[k]) continue;
      const arm = Math.min(Math.max(0.4 * pane.p[k] * camera.k, 3.5 * look.scale), 9 * look.scale);
      path.moveTo(x - arm, y - arm);
      path.lineTo(x + arm, y + arm);
      path.moveTo(x - arm, y + arm);
      path.lineTo(x + arm, y - arm);
    }
    g.lineCap = "round";
    for (const [width, colour] of [[5, this.theme.ground], [2.2, this.theme.text]]) {
      g.strokeStyle = css(colour);
      g.lineWidth = width * look.scale;
      g.stroke(path);
    }
  }
}

function polygon(path, points) {
  points.forEach(([x, y], k) => (k ? path.lineTo(x, y) : path.moveTo(x, y)));
  path.closePath();
}

// A strip along the rim of the unit disc at its foot, from u0 to u1 and that thick.
function rimStrip(u0, u1, thick) {
  const points = [];
  const at = (u, radius) => [u, -Math.sqrt(Math.max(radius * radius - u * u, 0))];
  for (let k = 0; k <= 6; k++) points.push(at(u0 + ((u1 - u0) * k) / 6, 1.01));
  for (let k = 6; k >= 0; k--) points.push(at(u0 + ((u1 - u0) * k) / 6, 1 - thick));
  return points;
}

function rampColour(ramp, share) {
  return ramp[Math.round(Math.min(Math.max(share, 0), 1) * (ramp.length - 1))];
}

// The grain that covers a place [R]; −1: none.
function grainAt(pane, moment, x, y) {
  const cell = cellAt(pane, moment);
  let [best, nearest] = [-1, 1];
  for (let grain = 0, k = moment * pane.count; grain < pane.count; grain++, k++) {
    if (!pane.there[k]) continue;
    const [p, q1, q2] = [pane.p[k], pane.q1[k], pane.q2[k]];
    for (const [ix, iy] of imagesOf(cell, pane.x[k], pane.y[k], p + Math.hypot(q1, q2))) {
      const [dx, dy, area] = [x - ix, y - iy, p * p - q1 * q1 - q2 * q2];
      const inside = Math.hypot(((p - q1) * dx - q2 * dy) / area, ((p + q1) * dy - q2 * dx) / area);
      if (inside <= nearest) [best, nearest] = [grain, inside];
    }
  }
  return best;
}
