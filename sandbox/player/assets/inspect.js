// One grain, looked at closely: what the window's panel tells.

// Its contacts, the strongest first: [the other grain or −1, force].
function contactsOf(pane, moment, grain) {
  const found = [];
  for (const pair of pane.active[moment]) {
    if (pane.i[pair] !== grain && pane.j[pair] !== grain) continue;
    const other = pane.i[pair] === grain ? pane.j[pair] : pane.i[pair];
    found.push([other < 0 ? -1 : other, pane.bearing[moment * pane.pairs + pair]]);
  }
  return found.sort((a, b) => b[1] - a[1]);
}

// Names and values of all there is to say about a grain.
function factsOf(pane, moment, grain) {
  const k = moment * pane.count + grain;
  const q = Math.hypot(pane.q1[k], pane.q2[k]);
  const angle = (((90 / Math.PI) * Math.atan2(pane.q2[k], pane.q1[k])) % 180 + 180) % 180;
  const area = (pane.p[k] ** 2 - q * q) / pane.rest[k] ** 2 - 1;
  const contacts = contactsOf(pane, moment, grain);
  const total = contacts.reduce((sum, [, force]) => sum + force, 0);
  const [forces, pressures] = [decimalsFor(run.tops.chains / 200), decimalsFor(pane.pressureTop / 200)];
  const facts = [
    [word("grain_ratio"), number(pane.nu[k], 2)],
    [word("grain_axes"), `${number(pane.p[k] + q, 3)} × ${number(pane.p[k] - q, 3)} R`],
    [word("grain_angle"), q > 0 ? `${number(angle, 0)}°` : "—"],
    [word("grain_rest"), `${number(pane.rest[k], 3)} R`],
    [word("grain_area"), `${number(100 * area, 1)} %`],
    [word("grain_pressure"), `${number(pane.pressure[k], pressures)} k`],
    [word("grain_contacts"), String(contacts.length)],
    [word("grain_total"), `${number(total, forces)} k R`],
  ];
  if (pane.known) {
    const unbalanced = 1e-9 * 2 ** (pane.unbalanced[k] / 2);
    const decimals = Math.max(0, -Math.floor(Math.log10(unbalanced)));
    facts.push([word("grain_unbalanced"), decimals > 7 ? "0 k R" : `≈ ${number(unbalanced, decimals)} k R`]);
  }
  return { facts, contacts, forces };
}

// The grain to look at next: along the strongest contact to one not yet seen, else the one seen longest ago, else the nearest.
function nextGrain(pane, moment, grain, seen) {
  const near = contactsOf(pane, moment, grain).map(([other]) => other).filter((other) => other >= 0);
  const fresh = near.find((other) => !seen.includes(other));
  if (fresh !== undefined) return fresh;
  if (near.length) return near.reduce((a, b) => (seen.indexOf(a) <= seen.indexOf(b) ? a : b));
  return nearestGrain(pane, moment, pane.x[moment * pane.count + grain], pane.y[moment * pane.count + grain], seen);
}

function nearestGrain(pane, moment, x, y, seen = []) {
  let [best, found] = [Infinity, -1];
  for (let grain = 0, k = moment * pane.count; grain < pane.count; grain++, k++) {
    if (!pane.there[k] || seen.includes(grain)) continue;
    const far = Math.hypot(pane.x[k] - x, pane.y[k] - y);
    if (far < best) [best, found] = [far, grain];
  }
  return found;
}

function lookAt(pane, grain) {
  state.pane = pane;
  state.grain = grain;
  state.seen = grain < 0 ? [] : [...state.seen.filter((seen) => seen !== grain), grain];
  draw();
  if (grain >= 0) announce(grainText());
}

function followContact() {
  const pane = run.panes[state.pane];
  if (state.grain < 0) {
    const [x0, y0, x1, y1] = pane.bounds;
    const handle = pane.handles[0]?.at.subarray(4 * state.moment, 4 * state.moment + 2) ?? [(x0 + x1) / 2, (y0 + y1) / 2];
    lookAt(state.pane, nearestGrain(pane, state.moment, ...handle));
  } else lookAt(state.pane, nextGrain(pane, state.moment, state.grain, state.seen));
}

function grainName(pane, grain) {
  const kind = pane.nu[state.moment * pane.count + grain] < 0 ? "auxetic" : "regular";
  return `${word("grain_label", { label: pane.labels[grain] })}, ${word("kind_" + kind)}`;
}

function grainText() {
  const pane = run.panes[state.pane];
  const { facts } = factsOf(pane, state.moment, state.grain);
  return [grainName(pane, state.grain), ...facts.map(([name, value]) => `${name} ${value}`)].join(". ");
}

function tellGrain() {
  const card = $("grain");
  const pane = run.panes[state.pane];
  const gone = state.grain < 0 || !pane.there[state.moment * pane.count + state.grain];
  if (gone) {
    if (!card.hidden) card.hidden = true;
    return;
  }
  card.hidden = false;
  const { facts, contacts, forces } = factsOf(pane, state.moment, state.grain);
  const focused = card.contains(document.activeElement) ? document.activeElement.dataset.key : null;
  const close = element("button", { type: "button", className: "small", textContent: word("let_go"), onclick: () => lookAt(state.pane, -1) });
  const along = element("button", { type: "button", className: "small", textContent: word("next_contact"), onclick: followContact });
  close.dataset.key = "close";
  along.dataset.key = "along";
  const list = element("dl", { className: "facts" });
  for (const [name, value] of facts) list.append(element("dt", { textContent: name }), element("dd", { textContent: value }));
  const touching = element("ul", { className: "touching" });
  for (const [other, force] of contacts) {
    const size = `${number(force, forces)} k R`;
    if (other < 0) touching.append(element("li", { textContent: `${word("grain_wall")}: ${size}` }));
    else {
      const text = word("grain_other", { label: pane.labels[other], force: size });
      const button = element("button", { type: "button", className: "small", textContent: text, onclick: () => lookAt(state.pane, other) });
      button.dataset.key = `grain ${other}`;
      touching.append(element("li", {}, button));
    }
  }
  const heading = [element("h2", { textContent: grainName(pane, state.grain) })];
  if (run.panes.length > 1) heading.push(element("p", { className: "soft", textContent: `${word("panel_packing")}: ${say(pane.title)}` }));
  card.replaceChildren(...heading, list, touching, element("p", { className: "row" }, along, close));
  if (focused) (card.querySelector(`[data-key="${focused}"]`) ?? close).focus();
}
