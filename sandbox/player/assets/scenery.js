// All of a packing at one moment: grains, bodies, force chains, handles, the sides of a periodic cell.

class Scenery extends Grains {
  draw(width, height) {
    const g = this.g;
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.fillStyle = css(this.theme.ground);
    g.fillRect(0, 0, width, height);
    g.save();
    this.clipToCell(width, height);
    this.grains();
    g.restore();
    this.bodies();
    g.save();
    this.clipToCell(width, height);
    if (this.look.chains || this.look.view.onlyChains) this.chains();
    this.crosses();
    g.restore();
    this.outlineOfCell(width, height);
    this.handles(width, height);
  }

  cellRect(width, height) {
    const { cell } = this;
    const left = cell.wide ? this.px(0) : 0;
    const right = cell.wide ? this.px(cell.width) : width;
    const top = cell.high ? this.py(cell.height) : 0;
    const bottom = cell.high ? this.py(0) : height;
    return [left, top, right - left, bottom - top];
  }

  clipToCell(width, height) {
    if (!this.cell) return;
    this.g.beginPath();
    this.g.rect(...this.cellRect(width, height));
    this.g.clip();
  }

  outlineOfCell(width, height) {
    if (!this.cell) return;
    const g = this.g;
    const [x, y, w, h] = this.cellRect(width, height);
    g.strokeStyle = css(this.theme.soft_text);
    g.lineWidth = 2 * this.look.scale;
    g.setLineDash([9 * this.look.scale, 6 * this.look.scale]);
    g.beginPath();
    if (this.cell.wide) for (const at of [x, x + w]) g.moveTo(at, y), g.lineTo(at, y + h);
    if (this.cell.high) for (const at of [y, y + h]) g.moveTo(x, at), g.lineTo(x + w, at);
    g.stroke();
    g.setLineDash([]);
  }

  // -- forces --

  chains() {
    const { g, pane, moment, look, camera, theme } = this;
    const base = moment * pane.count;
    const forces = pane.bearing.subarray(moment * pane.pairs, (moment + 1) * pane.pairs);
    const active = pane.active[moment];
    if (!active.length) return;
    let mean = 0;
    for (const pair of active) mean += forces[pair] / active.length;
    const BINS = 24;
    const bins = Array.from({ length: BINS }, () => []);
    for (const pair of active) bins[Math.min(Math.floor(Math.sqrt(forces[pair] / run.tops.chains) * BINS), BINS - 1)].push(pair);
    const plain = look.view.valued; // there the colour says something else
    const alone = look.view.onlyChains; // else grains keep their colours under them
    const [fadeFrom, fadeTo] = alone ? [0.3, 1] : [0.6, 1];
    const widest = Math.min(0.62 * camera.k, 13 * look.scale) * (alone ? 1 : plain ? 0.6 : 0.8);
    const clip = (value) => Math.min(Math.max(value, 0), 1);
    g.lineCap = "round";
    for (const rimmed of alone ? [false] : [true, false]) {
      bins.forEach((pairs, bin) => {
        const share = ((bin + 0.5) / BINS) ** 2;
        const force = share * run.tops.chains;
        const alpha = Math.min(clip((force / mean - fadeFrom) / (fadeTo - fadeFrom)), clip((share - 0.004) / 0.056));
        if (!pairs.length || alpha < 0.02) return;
        g.globalAlpha = alpha;
        g.lineWidth = widest * Math.sqrt(share) + (rimmed ? 1.2 * look.scale : 0);
        g.strokeStyle = css(rimmed ? theme.ground : plain ? theme.text : rampColour(theme.ramps.chains, share));
        for (const pair of pairs) {
          for (const [x0, y0, x1, y1] of this.contact(pair, base)) {
            g.beginPath(); // alone, as ellipses are
            g.moveTo(this.px(x0), this.py(y0));
            g.lineTo(this.px(x1), this.py(y1));
            g.stroke();
          }
        }
      });
    }
    g.globalAlpha = 1;
  }

  // The lines of a contact [R]: two where it leaves a periodic cell on one side and comes in on the other.
  contact(pair, base) {
    const { pane, cell, moment } = this;
    const first = base + pane.i[pair];
    const [x, y] = [pane.x[first], pane.y[first]];
    if (pane.j[pair] < 0) {
      const k = moment * pane.withBodies + pair - (pane.pairs - pane.withBodies);
      return imagesOf(cell, x, y, 1).map(([ix, iy]) => [ix, iy, ix + pane.dx[k], iy + pane.dy[k]]);
    }
    const second = base + pane.j[pair];
    let [dx, dy] = [pane.x[second] - x, pane.y[second] - y];
    if (!cell) return [[x, y, x + dx, y + dy]];
    if (cell.high) {
      const rows = Math.round(dy / cell.height);
      dx -= rows * cell.shift;
      dy -= rows * cell.height;
    }
    if (cell.wide) dx -= Math.round(dx / cell.width) * cell.width;
    const direct = [x, y, x + dx, y + dy];
    const [ox, oy] = [pane.x[second], pane.y[second]];
    return Math.hypot(x + dx - ox, y + dy - oy) < 1e-3 ? [direct] : [direct, [ox, oy, ox - dx, oy - dy]];
  }

  // -- bodies and handles --

  bodies() {
    const there = this.pane.bodies.filter((body) => body.there[this.moment]);
    for (const body of there) if (body.role === "wall") this.body(body);
    for (const body of there) if (body.role !== "wall") this.body(body);
  }

  body(body) {
    const { g, theme, look, camera } = this;
    const colour = theme[body.role] ?? theme.intruder;
    const edge = mix(colour, look.theme === "dark" ? theme.text : 0, 0.25);
    const numbers = body.shape.subarray(this.moment * body.columns, (this.moment + 1) * body.columns);
    const width = body.role === "wall" ? 0 : this.line;
    g.lineCap = "round";
    for (const [less, paint] of width ? [[0, edge], [width, colour]] : [[0, colour]]) {
      g.fillStyle = g.strokeStyle = css(paint);
      let at = 0;
      for (let disc = 0; disc < body.discs; disc++, at += 3) {
        g.beginPath();
        g.arc(this.px(numbers[at]), this.py(numbers[at + 1]), Math.max(camera.k * numbers[at + 2] - less, 0), 0, TURN);
        g.fill();
      }
      for (let line = 0; line < body.segments; line++, at += 5) {
        g.lineWidth = 2 * Math.max(Math.max(camera.k * numbers[at + 4], look.scale) - less, 0.5);
        g.beginPath();
        g.moveTo(this.px(numbers[at]), this.py(numbers[at + 1]));
        g.lineTo(this.px(numbers[at + 2]), this.py(numbers[at + 3]));
        g.stroke();
      }
      for (const corners of body.polygons) {
        const path = new Path2D();
        const points = [];
        for (let corner = 0; corner < corners; corner++, at += 2) points.push([this.px(numbers[at]), this.py(numbers[at + 1])]);
        polygon(path, points);
        g.fill(path);
        if (width && paint === colour) {
          g.strokeStyle = css(edge);
          g.lineWidth = width;
          g.stroke(path);
          g.strokeStyle = css(paint);
        }
      }
    }
  }

  handles(width, height) {
    const scale = Math.min(this.look.scale, Math.min(width, height) / 260);
    for (const handle of this.pane.handles) {
      const [x, y, tx, ty] = handle.at.subarray(4 * this.moment, 4 * this.moment + 4);
      const at = [this.px(x), this.py(y)];
      this.tautLine(at, [this.px(tx), this.py(ty)], scale);
      this.knob(at, handle.axis, scale);
    }
    for (const handle of this.pane.handles) this.push(handle, scale, width, height);
  }

  tautLine(here, there, scale) {
    const { g } = this;
    if (Math.hypot(here[0] - there[0], here[1] - there[1]) < 2 * scale) return;
    for (const [width, colour] of [[4.5, this.theme.ground], [2, this.theme.hand]]) {
      g.strokeStyle = css(colour);
      g.lineWidth = width * scale;
      g.beginPath();
      g.moveTo(...here);
      g.lineTo(...there);
      g.stroke();
    }
  }

  knob([x, y], axis, scale) {
    const { g, theme } = this;
    const size = 11 * scale;
    for (const [radius, colour] of [[size + 2 * scale, theme.ground], [size, mix(theme.hand, 0, 0.3)], [size - 1.5 * scale, theme.hand]]) {
      g.fillStyle = css(colour);
      g.beginPath();
      g.arc(x, y, radius, 0, TURN);
      g.fill();
    }
    const ways = axis ? [axis, [-axis[0], -axis[1]]] : [[1, 0], [0, 1], [-1, 0], [0, -1]];
    const path = new Path2D();
    for (const [wx, wy] of ways) {
      const [bx, by, sx, sy] = [x + 0.36 * size * wx, y - 0.36 * size * wy, -wy * 0.36 * size, -wx * 0.36 * size];
      polygon(path, [[x + 0.78 * size * wx, y - 0.78 * size * wy], [bx + sx, by + sy], [bx - sx, by - sy]]);
    }
    g.fillStyle = "#101418";
    g.fill(path);
  }

  // An arrow along the force of the hand, and its size.
  push(handle, scale, width, height) {
    const { g, theme } = this;
    const [x, y] = [this.px(handle.at[4 * this.moment]), this.py(handle.at[4 * this.moment + 1])];
    const [fx, fy] = handle.force.subarray(2 * this.moment, 2 * this.moment + 2);
    const size = Math.hypot(fx, fy);
    if (size < 0.005 * run.tops.hand) return;
    const [wx, wy] = [fx / size, -fy / size];
    const [start, long, head] = [17 * scale, Math.min(size / run.tops.hand, 1.2) * 96 * scale, 13 * scale];
    const neck = [x + (start + long) * wx, y + (start + long) * wy];
    const tip = [neck[0] + head * wx, neck[1] + head * wy];
    const side = [-wy * 0.62 * head, wx * 0.62 * head];
    const arrow = new Path2D();
    polygon(arrow, [tip, [neck[0] + side[0], neck[1] + side[1]], [neck[0] - side[0], neck[1] - side[1]]]);
    g.lineCap = "butt";
    for (const [wide, colour] of [[9, theme.ground], [5, theme.hand]]) {
      g.strokeStyle = g.fillStyle = css(colour);
      g.lineWidth = wide * scale;
      g.beginPath();
      g.moveTo(x + start * wx, y + start * wy);
      g.lineTo(...neck);
      g.stroke();
      if (wide === 9) {
        g.lineWidth = 4 * scale;
        g.stroke(arrow);
      }
      g.fill(arrow);
    }
    const text = `${number(size, decimalsFor(run.tops.hand) + 2)} k R`;
    const letters = 15 * Math.max(scale, 0.8 * this.look.scale);
    g.font = `600 ${letters}px ${FONT}`;
    const [w, h] = [g.measureText(text).width + letters, 1.5 * letters];
    const away = 0.5 * (w * Math.abs(wx) + h * Math.abs(wy)) + 5 * scale;
    const cx = Math.min(Math.max(tip[0] + away * wx, w / 2 + 2), width - w / 2 - 2);
    let cy = Math.min(Math.max(tip[1] + away * wy, h / 2 + 2), height - h / 2 - 2);
    if (Math.abs(cx - x) < w / 2 + start && Math.abs(cy - y) < h / 2 + start) cy = y > height / 2 ? h / 2 + 2 : height - h / 2 - 2;
    g.beginPath();
    g.roundRect(cx - w / 2, cy - h / 2, w, h, 6 * scale);
    g.fillStyle = css(theme.panel);
    g.fill();
    g.strokeStyle = css(theme.hand);
    g.lineWidth = 1.5 * scale;
    g.stroke();
    g.fillStyle = css(theme.text);
    g.textAlign = "center";
    g.textBaseline = "middle";
    g.fillText(text, cx, cy);
  }

  // A ring round the grain that is looked at.
  ring(grain) {
    const k = this.moment * this.pane.count + grain;
    if (!this.pane.there[k]) return;
    const path = new Path2D();
    for (const [x, y] of imagesOf(this.cell, this.pane.x[k], this.pane.y[k], this.pane.p[k])) {
      this.ellipse(path, [k, this.px(x), this.py(y)], 3 * this.look.scale);
    }
    for (const [width, colour] of [[7, this.theme.ground], [3.5, this.theme.text]]) {
      this.g.strokeStyle = css(colour);
      this.g.lineWidth = width * this.look.scale;
      this.g.stroke(path);
    }
  }
}
