// Callbacks that cannot stop what calls them.

// Returns a callback that reports what it throws: a bug in one must not keep others from being called.
export function guarded(callback) {
  return (...values) => {
    try {
      return callback(...values);
    } catch (error) {
      return reportBug(error);
    }
  };
}

export function reportBug(error) {
  console.error("a bug in the page:", error);
}
