// Theme and language: as this computer asks for them, and as they were chosen on the page before, in the address. What a key means.

const inAddress = new URLSearchParams(location.search);

function themeAsked(auto, otherwise) {
  if (!auto) return otherwise;
  const asked = inAddress.get("theme") ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
  return asked === "light" ? "light" : "dark";
}

function languageAsked(auto, languages, otherwise) {
  const wishes = auto ? [inAddress.get("language"), ...navigator.languages.map((code) => code.slice(0, 2))] : [];
  const found = [...wishes, otherwise].find((code) => languages.includes(code));
  return Math.max(languages.indexOf(found), 0);
}

// Show the words of one language, and let links take the choices along.
function settle(code, theme) {
  document.documentElement.lang = code;
  document.documentElement.dataset.theme = theme;
  for (const part of document.querySelectorAll("[data-said]")) part.hidden = part.lang !== code;
  for (const link of document.querySelectorAll("a[data-own]")) link.search = `?language=${code}&theme=${theme}`;
}

// What is printed on a key; where that is a letter of another script, what a keyboard with Latin letters has in that place.
function signOf({ key, code, shiftKey }) {
  if (!/^\p{L}$/u.test(key) || /^\p{Script=Latin}$/u.test(key)) return key;
  const place = { Comma: ",", Period: "." }[code] ?? code.replace("Key", "").toLowerCase();
  return shiftKey ? place.toUpperCase() : place;
}
