// What the kernels say as numbers, in words: templates as Python has them.

import type { Live } from "./live";

export interface Told {
  shown: boolean;
  event: string; // the kind of an event that begins with it, or ""
  text: () => string; // in the present language
}

export function told(live: Live, said: Float64Array): Told[] {
  const { sentence, said: places } = live.layout;
  const found: Told[] = [];
  for (let at = 0; at < said.length; at += sentence) {
    const row = said.subarray(at, at + sentence);
    const { text, values } = live.sentences[row[places.sentence]]!;
    const given = Object.fromEntries(values.map((name, k) => [name, row[places.values + k]]));
    found.push({ shown: row[places.shown] > 0, event: live.events[row[places.event]] ?? "", text: () => filled(say(text), given) });
  }
  return found;
}

// {count}, {force:.2g}, {change:+.1f}; and {count:grain|grains}, the form that goes with the number.
function filled(text: string, values: Record<string, number>): string {
  return text.replace(/\{(\w+)(?::([^{}]*))?\}/g, (_, name, form = "") => {
    const value = values[name];
    return form.includes("|") ? form.split("|")[PLURALS[language](value)] : formatted(value, form);
  });
}

function formatted(value: number, form: string): string {
  const digits = Number(/\d+/.exec(form)?.[0] ?? 6);
  if (form.endsWith("f")) return (form.startsWith("+") && value >= 0 ? "+" : "") + number(value, digits);
  return form.endsWith("g") ? short(Number(value.toPrecision(digits))) : String(value);
}
