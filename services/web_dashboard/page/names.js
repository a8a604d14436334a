// Names by which services tell apart what pages send them.

// No other page has it: of another tab or host, of the same one loaded anew. No time is in it, for clocks are set back.
export const PAGE = crypto.getRandomValues(new BigUint64Array(1))[0].toString(36);
let given = 0;

// A name that this page has not given before, and no other page gives.
export function newName() {
  return `${PAGE}-${++given}`;
}
