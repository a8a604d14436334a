// The size of the running model's map of postures, asked for once for each model.

import { link } from "../link.js";

let asked = { model: null, size: null };

// Resolves to {rows, columns}, null without a model.
export async function postureMap(model) {
  if (!model) return null;
  if (asked.model !== model) asked = { model, size: fetched(model) };
  return asked.size;
}

async function fetched(model) {
  try {
    const { model: there, posture_map: map } = await link.ask("som_classifier", "maps");
    if (there !== model) throw new Error("the classifier uses another model");
    return map;
  } catch (error) {
    if (!error.refused) asked.model = null;  // it may have it a moment later
    return null;
  }
}
