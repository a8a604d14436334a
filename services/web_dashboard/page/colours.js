// Colours: of the page's theme, and one for each action. They mark, and never carry meaning alone.

const ACTIONS = ["#2f7dc8", "#d46a1f", "#2e9460", "#b8456b", "#8062c9", "#9a7420", "#1f8f9c", "#c2519f", "#74801c", "#6a7686"];
const known = new Map();

// Gives each of a model's actions its colour, in the order of their names, so that it is the same on every page.
export function learn(labels) {
  for (const label of [...labels].sort()) colourOf(label);
}

export function colourOf(label) {
  if (!label) return ACTIONS.at(-1);
  if (!known.has(label)) known.set(label, ACTIONS[known.size % ACTIONS.length]);
  return known.get(label);
}

export function theme(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export const dark = matchMedia("(prefers-color-scheme: dark)");
