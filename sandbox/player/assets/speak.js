// Words and numbers in the present language.

const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';
const FINER = [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10];
let language = 0; // place in run.languages
let run; // the recording

// A text that is there in every language.
const say = (said) => said[language];

// A word of the page, with its values: {count}, and after it the form that goes with the number, {count:grain|grains}.
function word(key, values = {}) {
  const text = run.words[language][key] ?? key;
  return text.replace(/\{(\w+)(?::([^{}]*))?\}/g, (_, name, forms) =>
    (forms ? forms.split("|")[PLURALS[language](values[name])] : values[name]) ?? "");
}

function number(value, decimals) {
  if (!Number.isFinite(value)) return "—";
  let text = value.toFixed(decimals);
  if (Number(text) === 0) text = text.replace("-", "");
  return text.replace("-", "−").replace(".", run.words[language].decimal);
}

// A number as short as it can be told.
function short(value) {
  return number(value, (String(Number(value.toPrecision(4))).split(".")[1] ?? "").length);
}

// As many digits as tell values apart that differ by a hundredth of the spread.
function decimalsFor(spread) {
  if (!(spread > 0)) return 0;
  return Math.min(Math.max(0, -Math.floor(Math.log10(spread) + 1e-9)), 9);
}

function roundUp(value, steps = [1, 2, 5, 10]) {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return (steps.find((step) => value <= step * power * (1 + 1e-9)) ?? 10) * power;
}

// Of what is counted: whole ones.
function ticks(low, high, most, counts) {
  if (!(high > low)) return [];
  const step = Math.max(roundUp((high - low) / Math.max(most, 1)), counts && high - low >= 1 ? 1 : 0);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= Math.floor(high / step + 1e-9); k++) found.push(k * step);
  return found;
}

// A name and its unit: "stroke [R]".
function labelParts(label) {
  const found = /^(.*) \[(.*)\]$/.exec(label);
  return found ? [found[1], found[2]] : [label, ""];
}
