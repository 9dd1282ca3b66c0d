// Plotly, which the page holds compressed.

async function loadLibrary() {
  if (!("DecompressionStream" in window)) throw new Error("This browser cannot unpack the plotting library (it lacks DecompressionStream).");
  const packed = new Blob([bytes(byId("library").textContent)]);
  const text = await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).text();
  const script = document.createElement("script");
  script.textContent = text;
  document.head.append(script);
  script.remove();
  if (!window.Plotly) throw new Error("The plotting library could not be started.");
}

function hasWebGL() {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl2") ?? canvas.getContext("webgl");
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}

