// Quantities of robots in words, from milligrams and millimetres on.

const MILLIMETRES = 1000;

/** A mass: "2.3 kg", "84 g", "95 mg". @param {number} mass_kg */
export function massInWords(mass_kg) {
  if (mass_kg >= 1) return `${Number(mass_kg.toPrecision(3)).toLocaleString("en")}\u00a0kg`;
  if (mass_kg >= 1e-3) return `${Number((1e3 * mass_kg).toPrecision(3))}\u00a0g`;
  return `${Number((1e6 * mass_kg).toPrecision(2))}\u00a0mg`;
}

/** A length: "84 mm", "0.31 m", "1.2 m". @param {number} length_m */
export const lengthInWords = (length_m) => (length_m < 0.1
  ? `${Number((MILLIMETRES * length_m).toPrecision(2))}\u00a0mm`
  : `${Number(length_m.toPrecision(2)).toLocaleString("en")}\u00a0m`);
