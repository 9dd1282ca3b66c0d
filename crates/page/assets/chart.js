// A figure in the plane: its title in words, its axes in the colours of the page.

const MARKS = ["circle", "square", "diamond", "triangle-up", "cross", "star", "triangle-down", "x"];
// Okabe and Ito (2008): told apart by all eyes; the last two are darker on light paper.
const HUES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6bb1", "#7f7f7f"];
const DASHES = ["solid", "dash", "dot", "dashdot", "longdash"];

function layout(extra = {}) {
  const ink = theme.color("ink");
  const line = theme.color("line");
  const axis = (own) => ({ gridcolor: line, linecolor: theme.color("soft"), zerolinecolor: line, tickcolor: line, automargin: true, exponentformat: "power", ...own, title: { standoff: 8, ...(own?.title ?? {}) } });
  const { xaxis, yaxis, ...rest } = extra;
  return {
    font: { family: "system-ui, sans-serif", size: 12, color: ink },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    margin: { l: 56, r: 12, t: 8, b: 48 },
    hoverlabel: { bgcolor: theme.color("card"), font: { color: ink }, bordercolor: theme.color("soft"), namelength: -1 },
    legend: { orientation: "h", y: -0.25, font: { size: 11 } },
    xaxis: axis(xaxis),
    yaxis: axis(yaxis),
    ...rest,
  };
}

const CONFIG = { displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d", "sendDataToCloud"], toImageButtonOptions: { format: "svg" } };

/**
 * Adds a figure. `draw` returns the traces and the layout, and is called again when the theme changes, or what it draws does.
 * Returns a function that draws it again.
 */
function addChart(name, title, draw, tools = []) {
  const plot = element("div", { class: "plot", id: `chart-${name}`, role: "img", "aria-label": title });
  const figure = element("figure", {}, element("figcaption", {}, title), ...tools, plot);
  document.querySelector(".charts").append(figure);
  const show = () => {
    const { data, layout } = draw();
    return Plotly.react(plot, data, layout, CONFIG);
  };
  show();
  theme.changed.push(show);
  // Figures beside it, and the reader's window, change its place.
  new ResizeObserver(() => Plotly.Plots.resize(plot)).observe(plot);
  return show;
}

function chooser(id, title, options, act) {
  const select = element("select", { id, onchange: () => act(select.value) }, ...options.map(([value, text]) => element("option", { value }, text)));
  return { select, field: element("label", { class: "field", for: id }, element("span", {}, title), select) };
}

