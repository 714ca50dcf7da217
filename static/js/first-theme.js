// Runs before anything is painted, so that a chosen theme never flashes the other one first.
try {
  const theme = localStorage.getItem("hexapods:theme");
  if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
} catch {
  // Storage is forbidden: the system's theme it is.
}
