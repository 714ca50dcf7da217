// Globals that the page's modules find in a browser when they are imported, as far as the tests need it.

/** @type {[string, () => void][]} */
const listeners = [];
/** The entries of the history up to the present one. */
export const entries = ["/"];

Object.assign(globalThis, {
  addEventListener: (/** @type {string} */ type, /** @type {() => void} */ listener) =>
    listeners.push([type, listener]),
  document: {
    baseURI: "http://page.test/", documentElement: { dataset: {} }, hidden: false, addEventListener: () => {},
  },
  history: {
    state: null,
    replaceState: (/** @type {unknown} */ _state, /** @type {string} */ _title, /** @type {string} */ address) => {
      entries.splice(-1, 1, address);
      visit(address);
    },
    pushState: (/** @type {unknown} */ _state, /** @type {string} */ _title, /** @type {string} */ address) => {
      entries.push(address);
      visit(address);
    },
  },
  location: { origin: "http://page.test", pathname: "/", search: "", hash: "", href: "http://page.test/" },
  matchMedia: () => ({ matches: false, addEventListener: () => {} }),
});

/**
 * Set the page's address.
 * @param {string} address from the path on
 */
export function visit(address) {
  const { pathname, search, hash, href } = new URL(address, "http://page.test");
  Object.assign(globalThis.location, { pathname, search, hash, href });
}

/** Follow a link that changes the address's hash only. @param {string} address */
export function follow(address) {
  entries.push(address);
  visit(address);
  tell();
}

/** Go back to the entry before. */
export function goBack() {
  entries.pop();
  visit(entries[entries.length - 1]);
  tell();
}

const tell = () => listeners.filter(([type]) => type === "popstate").forEach(([, listener]) => listener());
