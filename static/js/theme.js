// The colour theme: light, dark, or the system's. The stage follows it.
import { computed, effect, signal } from "@preact/signals";

const KEY = "hexapods:theme";
const systemDark = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(systemDark.matches);

/** The choice: "auto", "light" or "dark". */
export const theme = signal(document.documentElement.dataset.theme ?? "auto");

/** The theme that is shown: "light" or "dark". */
export const shownTheme = computed(() =>
  theme.value === "auto" ? (systemIsDark.value ? "dark" : "light") : theme.value,
);

export const nextTheme = () => {
  const order = ["auto", "light", "dark"];
  theme.value = order[(order.indexOf(theme.value) + 1) % order.length];
};

export function followTheme() {
  systemDark.addEventListener("change", ({ matches }) => (systemIsDark.value = matches));
  effect(() => {
    if (theme.value === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme.value;
    store(theme.value);
  });
}

/** @param {string} value */
function store(value) {
  try {
    localStorage.setItem(KEY, value);
  } catch {
    // Storage is forbidden: kept until the page is closed.
  }
}
