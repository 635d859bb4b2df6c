// What sandbox/player/coding.py has written, read back: texts, and numbers over time.

function read(blocks, [at, count, rows, columns, step]) {
  const size = rows * columns;
  const values = new Float32Array(size);
  for (let column = 0, k = at; column < columns; column++) {
    let value = 0;
    for (let row = 0; row < rows; row++, k++) {
      let folded = blocks[k];
      for (let plane = 1; plane < count; plane++) folded |= blocks[k + plane * size] << (8 * plane);
      value += (folded >>> 1) ^ -(folded & 1);
      values[row * columns + column] = value * step;
    }
  }
  return values;
}

async function unpack(base64) {
  const text = atob(base64);
  const packed = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) packed[k] = text.charCodeAt(k);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const whole = new Uint8Array(await new Response(stream).arrayBuffer());
  const end = 4 + new DataView(whole.buffer).getUint32(0, true);
  const recording = JSON.parse(new TextDecoder().decode(whole.subarray(4, end)));
  const blocks = whole.subarray(end);
  for (const pane of recording.panes) readPane(pane, blocks, recording.increments.length);
  for (const view of recording.views) if (view.valued && view.top === null) view.top = topOf(view, recording.panes);
  return recording;
}

function readPane(pane, blocks, moments) {
  const { labels, known } = pane.grains;
  pane.moments = moments;
  pane.labels = labels;
  pane.known = known;
  pane.count = labels.length;
  for (const [name, block] of Object.entries(pane.grains)) {
    if (name !== "labels" && name !== "known") pane[name] = read(blocks, block);
  }
  pane.rubs = pane.spin.some((angle) => angle !== 0);
  const touching = pane.contacts;
  pane.i = read(blocks, touching.i);
  pane.j = read(blocks, touching.j);
  pane.pairs = pane.i.length;
  pane.bearing = read(blocks, touching.force);
  pane.dx = read(blocks, touching.dx);
  pane.dy = read(blocks, touching.dy);
  pane.withBodies = moments ? pane.dx.length / moments : 0;
  pane.active = activePairs(pane);
  for (const body of pane.bodies) {
    body.columns = body.shape[3];
    body.shape = read(blocks, body.shape);
    body.there = read(blocks, body.there);
  }
  for (const handle of pane.handles) {
    handle.at = read(blocks, handle.at);
    handle.force = read(blocks, handle.force);
  }
  if (pane.box) pane.box.size = read(blocks, pane.box.size);
  pane.stroke = read(blocks, pane.stroke);
  pane.force = read(blocks, pane.force);
}

// For each moment the pairs that bear a force.
function activePairs(pane) {
  const active = [];
  for (let moment = 0; moment < pane.moments; moment++) {
    const some = [];
    for (let pair = 0, k = moment * pane.pairs; pair < pane.pairs; pair++, k++) if (pane.bearing[k] > 0) some.push(pair);
    active.push(Uint32Array.from(some));
  }
  return active;
}

// (a − b)/(a + b) of the semi-axes, and the percentage of the area at rest that is lost.
function shapeOf(pane, k) {
  return Math.hypot(pane.q1[k], pane.q2[k]) / pane.p[k];
}

function areaLost(pane, k) {
  const area = pane.p[k] ** 2 - pane.q1[k] ** 2 - pane.q2[k] ** 2;
  return Math.max(100 * (1 - area / pane.rest[k] ** 2), 0);
}

const MEASURES = {
  pressure: (pane, k) => pane.pressure[k],
  fringes: (pane, k) => pane.stress[k],
  motion: (pane, k) => pane.motion[k],
  shape: shapeOf,
  area: areaLost,
};

// The scale of a view that follows from shapes: all but the largest percent fit in.
function topOf(view, panes) {
  const values = [];
  for (const pane of panes) {
    for (let k = 0; k < pane.p.length; k++) if (pane.there[k]) values.push(MEASURES[view.name](pane, k));
  }
  values.sort((a, b) => a - b);
  return roundUp(Math.max(values[Math.floor(0.99 * (values.length - 1))] || 0, view.least), FINER);
}
