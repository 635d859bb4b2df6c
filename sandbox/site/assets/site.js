// A page that plays nothing: its language and its theme.

let language = languageAsked(true, PAGE.languages, document.documentElement.lang);
let theme = themeAsked(true, "dark");

function show() {
  settle(PAGE.languages[language], theme);
  document.title = PAGE.titles[language];
  const other = (language + 1) % PAGE.languages.length;
  const [light, choice] = [document.getElementById("theme"), document.getElementById("language")];
  light.textContent = theme === "dark" ? PAGE.light[language] : PAGE.dark[language];
  choice.textContent = PAGE.names[other];
  choice.lang = PAGE.languages[other];
}

document.getElementById("theme").addEventListener("click", () => {
  theme = theme === "dark" ? "light" : "dark";
  show();
});
document.getElementById("language").addEventListener("click", () => {
  language = (language + 1) % PAGE.languages.length;
  show();
});
show();
document.documentElement.dataset.ready = Math.round(performance.now());
