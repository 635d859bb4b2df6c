// What stands on the page in the present language: names, events, legend.

function speakAll() {
  settle(run.languages[language], state.theme);
  document.title = say(run.title);
  const texts = { title: say(run.title), question: say(run.question), "view-label": word("view"), "speed-label": word("speed") };
  Object.assign(texts, { "story-title": word("story"), "events-title": word("events"), "keys-title": word("keys") });
  Object.assign(texts, { "letters-label": word("letters"), chains: word("chains") });
  for (const [id, text] of Object.entries(texts)) setText($(id), text);
  const other = (language + 1) % run.languages.length;
  setText($("language"), run.words[other].name);
  $("language").lang = run.languages[other];
  $("choices").setAttribute("aria-label", word("choices"));
  $("stage").setAttribute("aria-label", word("stage"));
  $("plot-part").setAttribute("aria-label", word("plot"));
  $("time-part").setAttribute("aria-label", word("time"));
  $("time").setAttribute("aria-label", word("time"));
  $("plot").setAttribute("aria-label", word("plot_picture", { force: say(run.labels.force), stroke: say(run.labels.stroke) }));
  for (const id of ["back", "on"]) {
    $(id).replaceChildren(icon(ICONS[id]));
    $(id).setAttribute("aria-label", word(id));
    $(id).title = word(id);
  }
  $("view").replaceChildren(...run.views.map((each, k) => element("option", { value: k, textContent: say(each.title), selected: k === state.view })));
  $("speed").setAttribute("aria-label", word("speed"));
  const names = ["1/8", "1/4", "1/2", "1", "2", "4"];
  $("speed").replaceChildren(...names.map((name, k) => element("option", { value: k, textContent: `${name} ×`, selected: k === state.speed })));
  makeEvents();
  $("keys").replaceChildren(...run.keys[language].flatMap(([key, does]) => [element("dt", { textContent: key }), element("dd", { textContent: does })]));
  showPlay();
  showTheme();
  makeLegend();
  arrange();
  announce();
}

function makeEvents() {
  const all = eventsInOrder();
  $("events-part").hidden = !all.length;
  $("marks").replaceChildren();
  $("events").replaceChildren();
  const marked = [];
  for (const event of all) {
    const whose = run.panes.length > 1 ? `${say(run.panes[event.pane].title)} · ` : "";
    const text = `${whose}${word("increment", { increment: event.increment })}: ${say(event.text)}`;
    const choose = () => seek(event.moment);
    const mark = element("button", { type: "button", className: "mark", tabIndex: -1, title: text, onclick: choose }, shapeOfEvent(event.kind));
    mark.setAttribute("aria-hidden", "true"); // the list says the same, and is on the way of Tab
    mark.style.left = `${(100 * event.moment) / Math.max(last(), 1)}%`;
    if (marked.every(([kind, moment]) => kind !== event.kind || event.moment - moment > 0.012 * last())) {
      marked.push([event.kind, event.moment]); // of many that lie on one another the first; the list has all
      $("marks").append(mark);
    }
    $("events").append(element("li", {}, element("button", { type: "button", onclick: choose }, shapeOfEvent(event.kind), element("span", { textContent: text }))));
  }
}

function makeLegend() {
  $("legend").replaceChildren(...legendOf(run.panes, view(), state.theme, state.chains));
}

function showTheme() {
  settle(run.languages[language], state.theme);
  setText($("theme"), word(state.theme === "dark" ? "to_light" : "to_dark"));
  $("chains").setAttribute("aria-pressed", String(state.chains));
  for (const pane of run.panes) {
    const { colour, dash } = pane.look;
    pane.nodes.swatch.style.background = dash.length
      ? `repeating-linear-gradient(to right, ${css(colour)} 0 ${dash[0]}px, transparent ${dash[0]}px ${dash[0] + dash[1]}px)`
      : css(colour);
  }
}
