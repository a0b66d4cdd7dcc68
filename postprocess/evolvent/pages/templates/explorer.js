"use strict";
(() => {
  const element = (id) => document.getElementById(id);
  const facts = JSON.parse(element("explorer-facts").textContent);
  const panels = new Map(); // figure of each displayed quantity, by name
  let range = facts.window; // time range of all figures; null: all
  let linking = false;

  async function unpacked(id) {
    const packed = Uint8Array.from(atob(element(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  // Times of all rows; then for each line its rows among them, as differences, and its values.
  function readLines(buffer) {
    const times = new Float64Array(buffer, 0, facts.times);
    let offset = times.byteLength;
    for (const quantity of facts.quantities) {
      for (const line of quantity.lines) {
        const steps = new Uint32Array(buffer, offset, line.size);
        line.y = new Float32Array(buffer, offset + steps.byteLength, line.size);
        offset += steps.byteLength + line.y.byteLength;
        line.x = new Float64Array(line.size);
        let row = 0;
        steps.forEach((step, i) => { line.x[i] = times[row += step]; });
      }
    }
  }

  function traces(quantity) {
    const unit = quantity.unit ? ` ${quantity.unit}` : "";
    const shown = quantity.lines.map((line, i) => ({
      type: "scatter", mode: "lines", name: line.label, x: line.x, y: line.y, connectgaps: false,
      line: { width: 1.4, ...facts.styles[i % facts.styles.length] },
      hovertemplate: `%{y:.5g}${unit}`,
    }));
    const marks = quantity.extremes;
    if (marks.length) {
      shown.push({
        type: "scatter", mode: "markers", name: "extremes over the run", cliponaxis: false,
        x: marks.map((m) => m[0]), y: marks.map((m) => m[1]), text: marks.map((m) => m[2]),
        marker: { symbol: "diamond-open", size: 9, color: "#444", line: { width: 1.6 } },
        hovertemplate: `%{y:.5g}${unit} (%{text})`,
      });
    }
    return shown;
  }

  function eventTraces() {
    return facts.events.map((kind) => ({
      type: "scatter", mode: "markers", name: kind.label, x: kind.times, y: kind.times.map(() => kind.label),
      marker: { symbol: "line-ns-open", size: 10, color: "#10243e" }, showlegend: false,
    }));
  }

  // Value range of a figure between two times, with a margin; undefined if there are no values.
  function height(plot) {
    let low = Infinity, high = -Infinity;
    for (const trace of plot.data) {
      if (trace.visible === "legendonly" || trace.visible === false) continue;
      for (let i = 0; i < trace.x.length; i += 1) {
        if (trace.x[i] >= range[0] && trace.x[i] <= range[1] && Number.isFinite(trace.y[i])) {
          low = Math.min(low, trace.y[i]);
          high = Math.max(high, trace.y[i]);
        }
      }
    }
    const room = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
    return low <= high ? [low - room, high + room] : undefined;
  }

  function ranges(plot) {
    if (!range) return { "xaxis.range": [...facts.whole], "yaxis.autorange": true };
    const change = { "xaxis.range": [...range] };
    const values = plot.isEvents ? undefined : height(plot);
    if (values) change["yaxis.range"] = values;
    return change;
  }

  async function link(changed, origin) {
    range = changed;
    linking = true;
    const others = [...panels.values()].filter((plot) => plot !== origin);
    await Promise.all(others.map((plot) => Plotly.relayout(plot, ranges(plot))));
    linking = false;
  }

  function follow(plot, change) {
    if (linking || !Object.keys(change).some((key) => key.startsWith("xaxis"))) return;
    const shown = plot.layout.xaxis.range;
    const isWhole = shown.every((time, i) => time === facts.whole[i]);
    link(isWhole ? null : [...shown], plot);
  }

  async function show(name) {
    const isEvents = name === "events";
    const quantity = facts.quantities.find((q) => q.name === name);
    const figure = document.createElement("figure");
    const title = document.createElement("h3");
    title.textContent = isEvents ? "when events happened" : quantity.text;
    const plot = document.createElement("div");
    plot.isEvents = isEvents;
    figure.append(title, plot);
    element("panels").append(figure);
    panels.set(name, plot);
    const unit = isEvents ? "" : quantity.unit;
    const layout = {
      height: isEvents ? 130 + 24 * facts.events.length : 320,
      margin: { l: 60, r: 52, t: 12, b: 44 },
      modebar: { orientation: "v" },
      font: { family: "system-ui, sans-serif", size: 13, color: "#1b1f24" },
      xaxis: { range: [...facts.whole], title: { text: `time [${facts.time_unit}]`, standoff: 6 }, gridcolor: "#e2e4e7", zeroline: false },
      yaxis: { title: { text: unit }, gridcolor: "#e2e4e7", zeroline: false, automargin: true },
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom" },
      showlegend: !isEvents, hovermode: isEvents ? "closest" : "x unified", dragmode: "zoom",
    };
    const options = {
      responsive: true, displaylogo: false, displayModeBar: true, doubleClick: "reset",
      modeBarButtons: [["zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "resetScale2d", "toImage"]],
    };
    await Plotly.newPlot(plot, isEvents ? eventTraces() : traces(quantity), layout, options);
    if (range) {
      linking = true;
      await Plotly.relayout(plot, ranges(plot));
      linking = false;
    }
    plot.on("plotly_relayout", (change) => follow(plot, change));
  }

  function hide(name) {
    const plot = panels.get(name);
    panels.delete(name);
    Plotly.purge(plot);
    plot.parentElement.remove();
  }

  function search() {
    const filter_text = element("find").value.toLowerCase();
    for (const label of document.querySelectorAll("#explorer fieldset label")) {
      label.hidden = !`${label.textContent} ${label.firstElementChild.value}`.toLowerCase().includes(filter_text);
    }
  }

  async function start() {
    if (!("DecompressionStream" in window)) throw new Error("they need a browser of 2023 or newer");
    const [library, numbers] = await Promise.all([unpacked("explorer-library"), unpacked("explorer-numbers")]);
    const script = document.createElement("script");
    script.textContent = new TextDecoder().decode(library);
    document.head.append(script);
    readLines(numbers);
    for (const name of facts.first) await show(name);
    for (const box of document.querySelectorAll("#explorer fieldset input")) {
      box.addEventListener("change", () => (box.checked ? show(box.value) : hide(box.value)));
    }
    element("find").addEventListener("input", search);
    element("whole").addEventListener("click", () => link(null));
    element("window")?.addEventListener("click", () => link(facts.window));
    element("explorer").dataset.state = "ready";
  }

  start().catch((error) => {
    element("trouble").textContent = `The pictures cannot be drawn: ${error.message}.`;
    element("trouble").hidden = false;
    throw error;
  });
})();
