// Sets the chosen theme before the first paint, so that the other one never flashes.
try {
  const theme = localStorage.getItem("hexapods:theme");
  if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
} catch {
  // Storage is forbidden: the system's theme applies.
}
