// Numbers for people.

const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

/** With so many digits, and without zeros at the end. */
function short(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e-4 && size < 1e6 ? Number(value.toPrecision(digits)).toString() : value.toExponential(digits - 1);
  return text.replace("-", "−");
}

/** With the prefix that leaves one to three places before the point. */
function withUnit(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return `0 ${unit}`;
  const [factor, prefix] = PREFIXES.find(([factor]) => Math.abs(value) >= 0.9995 * factor) ?? PREFIXES.at(-1);
  return `${short(value / factor, digits)} ${prefix}${unit}`;
}

/** The factor and the prefix for values up to `largest`. */
function prefixFor(largest) {
  return PREFIXES.find(([factor]) => largest >= factor) ?? [1, ""];
}

/** The value below which this share of the sorted values lies. */
function quantile(sorted, share) {
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : NaN;
}

/** Text for Plotly, which reads some tags and entities in labels. */
function label(text) {
  return String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/\$/g, "&#36;");
}

/** A label that fits a narrow place. */
function cut(text, most = 34) {
  return text.length > most ? `${text.slice(0, most - 1)}…` : text;
}

