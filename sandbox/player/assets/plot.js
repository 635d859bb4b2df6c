// Force against stroke, a curve a packing: what has been is strong, what comes is faint. A click goes to that moment.

class Plot {
  constructor(canvas, seek) {
    this.canvas = canvas;
    this.seek = seek;
    const pick = (event) => {
      if (event.type === "pointermove" && !(event.buttons & 1)) return;
      if (event.type === "pointerdown") canvas.setPointerCapture(event.pointerId);
      const place = canvas.getBoundingClientRect();
      const moment = this.nearest((event.clientX - place.left) * this.ratio, (event.clientY - place.top) * this.ratio);
      if (moment !== null) seek(moment);
    };
    canvas.addEventListener("pointerdown", pick);
    canvas.addEventListener("pointermove", pick);
  }

  get ratio() {
    return this.canvas.width / Math.max(this.canvas.clientWidth, 1);
  }

  axes() {
    let [low, high, bottom, top] = [0, 0, 0, 0.01];
    for (const pane of run.panes) {
      for (const value of pane.stroke) [low, high] = [Math.min(low, value), Math.max(high, value)];
      for (const value of pane.force) [bottom, top] = [Math.min(bottom, value), Math.max(top, value)];
    }
    top = roundUp(top, FINER);
    bottom = bottom < -0.02 * top ? -roundUp(-bottom, FINER) : 0;
    return { low, high: high > low ? high : low + 1, bottom, top };
  }

  // All that does not move is drawn once.
  draw(moment, look) {
    const { canvas } = this;
    const key = [canvas.width, canvas.height, look.theme, look.scale, language].join();
    if (key !== this.key) {
      this.key = key;
      this.still = new OffscreenCanvas(canvas.width, canvas.height);
      this.g = this.still.getContext("2d");
      this.ground(look);
    }
    this.g = canvas.getContext("2d");
    this.g.drawImage(this.still, 0, 0);
    if (!this.box) return;
    const theme = run.themes[look.theme];
    for (const pane of [...run.panes].reverse()) this.curve(pane, moment, theme, look.scale, true);
    for (const pane of [...run.panes].reverse()) this.present(pane, moment, theme, look.scale);
  }

  ground(look) {
    const { canvas, g } = this;
    const theme = run.themes[look.theme];
    const s = look.scale;
    const letters = 13 * s;
    const axes = (this.known ??= this.axes());
    g.fillStyle = css(theme.panel);
    g.fillRect(0, 0, canvas.width, canvas.height);
    g.font = `${letters}px ${FONT}`;
    const most = Math.max(Math.floor((canvas.height - 4 * letters) / (1.9 * letters)), 1);
    const marks = ticks(axes.bottom, axes.top, most, run.panes.every((pane) => pane.counts));
    const digits = decimalsFor(marks.length > 1 ? marks[1] - marks[0] : 1);
    const gutter = Math.max(...marks.map((value) => g.measureText(number(value, digits)).width), 0) + 16 * s;
    const [left, top, right, bottom] = [gutter, 2.2 * letters, canvas.width - 14 * s, canvas.height - 1.9 * letters];
    this.x = (stroke) => left + ((stroke - axes.low) / (axes.high - axes.low)) * (right - left);
    this.y = (force) => bottom - ((force - axes.bottom) / (axes.top - axes.bottom)) * (bottom - top);
    this.box = right - left < 20 || bottom - top < 10 ? null : [left, right, top, bottom];
    if (!this.box) return;
    this.headline(theme, s, left, right, letters);
    this.grid(marks, digits, axes, theme, s, [left, right, bottom, letters]);
    if (run.limit !== null && run.limit <= axes.top) this.limit(theme, s, left, right, letters);
    for (const pane of [...run.panes].reverse()) this.curve(pane, pane.moments - 1, theme, s, false);
  }

  headline(theme, s, left, right, letters) {
    const { g } = this;
    g.textBaseline = "middle";
    g.textAlign = "left";
    g.fillStyle = css(theme.soft_text);
    const label = say(run.labels.force);
    g.fillText(label, left, letters, right - left);
    let end = right;
    const taken = left + g.measureText(label).width + 20 * s;
    const kinds = [...new Set(run.panes.flatMap((pane) => pane.events.map((event) => event.kind)))];
    for (const kind of kinds.reverse()) {
      const name = word("event_" + kind);
      const width = g.measureText(name).width + 26 * s;
      if (end - width < taken) break;
      end -= width;
      eventMark(g, end + 6 * s, letters, kind, 6 * s, theme);
      g.fillStyle = css(theme.soft_text);
      g.fillText(name, end + 16 * s, letters);
    }
  }

  grid(marks, digits, axes, theme, s, [left, right, bottom, letters]) {
    const { g } = this;
    g.lineWidth = Math.max(Math.round(s), 1);
    for (const value of marks) {
      const y = Math.round(this.y(value)) + 0.5;
      g.strokeStyle = css(value === 0 ? theme.soft_text : theme.hairline);
      g.beginPath();
      g.moveTo(left, y);
      g.lineTo(right, y);
      g.stroke();
      g.fillStyle = css(theme.soft_text);
      g.textAlign = "right";
      g.fillText(number(value, digits), left - 8 * s, y);
    }
    const label = say(run.labels.stroke);
    const free = right - g.measureText(label).width - 14 * s;
    const line = bottom + letters;
    g.fillText(label, right, line);
    const counts = !labelParts(label)[1] && run.panes.every((pane) => pane.stroke.every(Number.isInteger));
    const along = ticks(axes.low, axes.high, Math.max(Math.floor((right - left) / (6 * letters)), 1), counts);
    const places = decimalsFor(along.length > 1 ? along[1] - along[0] : 1);
    g.textAlign = "center";
    for (const value of along) {
      const [x, name] = [this.x(value), number(value, places)];
      g.fillRect(Math.round(x), bottom, g.lineWidth, 4 * s);
      if (x + g.measureText(name).width / 2 < free) g.fillText(name, x, line);
    }
  }

  limit(theme, s, left, right, letters) {
    const { g } = this;
    const y = this.y(run.limit);
    g.strokeStyle = css(theme.hand);
    g.lineWidth = 1.6 * s;
    g.setLineDash([2 * s, 5 * s]);
    g.beginPath();
    g.moveTo(left, y);
    g.lineTo(right, y);
    g.stroke();
    g.setLineDash([]);
    g.textAlign = "left";
    g.fillStyle = css(theme.soft_text);
    const text = word("hand_limit", { strength: short(run.limit) });
    const middle = y < 3.4 * letters ? y + 0.8 * letters : y - 0.8 * letters;
    // Where no curve runs, if there is such a place.
    const [pad, width] = [6 * s, g.measureText(text).width];
    const lefts = [left + pad, right - pad - width];
    const free = lefts.find((from) =>
      run.panes.every((pane) =>
        pane.stroke.every((stroke, k) => {
          const x = this.x(stroke);
          return x < from - pad || x > from + width + pad || Math.abs(this.y(pane.force[k]) - middle) > 0.8 * letters;
        }),
      ),
    );
    g.fillText(text, free ?? lefts[0], middle);
  }

  // A curve up to a moment, or all of it faintly.
  curve(pane, moment, theme, s, strong) {
    const { g } = this;
    const [left, right, top, bottom] = this.box;
    g.save();
    g.beginPath();
    g.rect(left - 6 * s, top - 6 * s, right - left + 12 * s, bottom - top + 12 * s);
    g.clip();
    g.lineJoin = "round";
    g.setLineDash(pane.look.dash.map((length) => length * s));
    g.strokeStyle = css(strong ? pane.look.colour : mix(pane.look.colour, theme.panel, 0.5));
    g.lineWidth = (strong ? 2.2 : 1.3) * s;
    g.beginPath();
    let [x, y] = [NaN, NaN];
    for (let k = 0; k <= Math.min(pane.at[moment], pane.stroke.length - 1); k++) {
      const [nx, ny] = [this.x(pane.stroke[k]), this.y(pane.force[k])];
      if (Math.abs(nx - x) + Math.abs(ny - y) < 0.7) continue; // nobody could see it
      [x, y] = [nx, ny];
      g.lineTo(x, y);
    }
    g.stroke();
    g.restore();
  }

  // A cursor and a dot at the present moment, and the marks of events.
  present(pane, moment, theme, s) {
    const { g } = this;
    const [, , top, bottom] = this.box;
    const now = Math.min(pane.at[moment], pane.stroke.length - 1);
    const [x, y] = [this.x(pane.stroke[now]), this.y(pane.force[now])];
    g.strokeStyle = css(mix(theme.text, theme.panel, 0.45));
    g.lineWidth = Math.max(Math.round(s), 1);
    g.beginPath();
    g.moveTo(x, top);
    g.lineTo(x, bottom);
    g.stroke();
    const kept = [];
    for (const event of [...pane.events].reverse()) {
      const at = this.x(event.stroke);
      if (kept.some((other) => Math.abs(at - other) < 9.6 * s)) continue;
      kept.push(at);
      eventMark(g, at, this.y(event.force), event.kind, 6 * s, theme);
    }
    for (const [radius, colour] of [[6.5, theme.panel], [4.5, pane.look.colour]]) {
      g.fillStyle = css(colour);
      g.beginPath();
      g.arc(x, y, radius * s, 0, TURN);
      g.fill();
    }
  }

  // The moment whose point on a curve is nearest; sideways counts more, as one points along the stroke.
  nearest(px, py) {
    if (!this.x) return null;
    let [best, found] = [Infinity, null];
    for (const pane of run.panes) {
      for (let moment = 0; moment < pane.moments; moment++) {
        const k = Math.min(pane.at[moment], pane.stroke.length - 1);
        const far = (this.x(pane.stroke[k]) - px) ** 2 + 0.1 * (this.y(pane.force[k]) - py) ** 2;
        if (far < best) [best, found] = [far, moment];
      }
    }
    return found;
  }
}

// The sign of an event: a shape for each kind, never colour alone.
function eventMark(g, x, y, kind, size, theme) {
  const path = new Path2D();
  polygon(path, (run.shapes[kind] ?? run.shapes.clog).map(([u, v]) => [x + u * size, y - v * size]));
  g.fillStyle = css(theme.event);
  g.strokeStyle = css(theme.dark ? theme.panel : mix(theme.event, 0, 0.45));
  g.lineWidth = 0.4 * size;
  g.lineJoin = "round";
  g.stroke(path);
  g.fill(path);
}
