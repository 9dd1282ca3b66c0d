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
  /** From below to above zero: violet and orange, which all eyes tell apart. */
  balance() {
    const middle = this.isDark() ? "#75797e" : "#b5b5b5";
    const ends = this.isDark() ? ["#ffa23e", "#c98745", middle, "#a08cd8", "#cbb5ff"] : ["#b35806", "#d98f3f", middle, "#7d6bb0", "#542788"];
    return ends.map((color, i) => [i / 4, color]);
  },
};

