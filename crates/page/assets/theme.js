// Light and dark: what the reader's system says, until the button is pressed.

const theme = {
  changed: [],
  isDark() {
    const chosen = document.documentElement.dataset.theme;
    return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  },
  toggle() {
    document.documentElement.dataset.theme = this.isDark() ? "light" : "dark";
    this.changed.forEach((act) => act());
  },
  /** The value of a variable of the style. */
  color(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  },
  /** From low to high: viridis without the end that the background swallows. */
  ramp() {
    const colors = this.isDark()
      ? ["#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"]
      : ["#440154", "#443983", "#31688e", "#21918c", "#2ba06f", "#5aa83c", "#8fa31e"];
    return colors.map((color, i) => [i / (colors.length - 1), color]);
  },
  /** From below to above zero: blue and orange, which all eyes tell apart. */
  balance() {
    const middle = this.isDark() ? "#6b6b6b" : "#b5b5b5";
    const ends = this.isDark() ? ["#ff9d3b", "#c97f3e", middle, "#4f94c4", "#6cc3ff"] : ["#b34700", "#d98a4d", middle, "#4f8fbd", "#005a9c"];
    return ends.map((color, i) => [i / 4, color]);
  },
};

