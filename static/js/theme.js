// Light, dark, or as the system has it. The stage follows.
import { computed, effect, signal } from "@preact/signals";

const KEY = "hexapods:theme";
const systemDark = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(systemDark.matches);

/** "auto", "light" or "dark". */
export const theme = signal(document.documentElement.dataset.theme ?? "auto");

/** What it comes to: "light" or "dark". */
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
    remember(theme.value);
  });
}

function remember(value) {
  try {
    localStorage.setItem(KEY, value);
  } catch {
    // Storage is forbidden: it lasts as long as the page.
  }
}
