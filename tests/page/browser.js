// Globals that the page's modules find in a browser when they are imported, as far as the tests need it.


Object.assign(globalThis, {
  addEventListener: () => {},
  document: { baseURI: "http://page.test/", documentElement: { dataset: {} } },
  history: {
    state: null,
    replaceState: (/** @type {unknown} */ _state, /** @type {string} */ _title, /** @type {string} */ address) =>
      visit(address),
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
