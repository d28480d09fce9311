// Parallel coordinates and a scatter of the same variants, with linked selections.
(() => {
  // Parallel coordinates need WebGL; without it the static figure stays.
  if (!document.createElement("canvas").getContext("webgl")) return;
  document.body.classList.add("linked");
  const data = JSON.parse(document.getElementById("variants").textContent);
  const across = document.getElementById("across"), scatter = document.getElementById("scatter");
  const told = document.getElementById("selected"), chosen = document.getElementById("chosen");
  const [alongX, alongY] = ["along-x", "along-y"].map((id) => document.getElementById(id));
  const grey = "#c9cdd1", everyone = data.shades.map((_, i) => i);
  // Below 0 a line is grey: the variant misses the condition or isn't selected.
  const scale = [[0, grey], [1 / 3, grey], ...data.colours.map((c, i, all) => [(1 + 2 * i / (all.length - 1)) / 3, c])];
  const look = { cmin: -0.5, cmax: 1, colorscale: scale, showscale: false };
  const font = { family: "system-ui, sans-serif", size: 12 };
  const deepest = Math.max(...data.columns.map((column) => column.lines.split("<br>").length));
  const settings = { responsive: true, displaylogo: false };
  const shadesOf = (rows) => {
    const there = new Set(rows);
    return data.shades.map((shade, i) => (there.has(i) ? shade : -0.5));
  };

  const tell = (rows) => {
    told.textContent = rows ? `${rows.length} of ${everyone.length} shown variants selected` : "";
    chosen.replaceChildren();
    if (!rows) return;
    const add = (cells, kind) => {
      const row = chosen.insertRow();
      cells.forEach((cell) => {
        const made = document.createElement(kind);
        made.textContent = cell;
        row.append(made);
      });
    };
    add(["variant", ...data.columns.map((column) => column.label)], "th");
    rows.slice(0, 10).forEach((i) => add([data.numbers[i], ...data.columns.map((column) => column.values[i])], "td"));
  };

  const drawAcross = () => Plotly.newPlot(across, [{
    type: "parcoords", labelside: "bottom",
    line: { color: data.shades, ...look },
    dimensions: data.columns.map((column) => ({ label: column.lines, values: column.values })),
    labelfont: { ...font, size: 11 }, tickfont: { ...font, size: 10 }, rangefont: { ...font, size: 9 },
  }], {
    margin: { l: 55, r: 65, t: 30, b: 40 + 15 * deepest }, font, height: 400 + 15 * deepest,
    width: Math.max(across.parentElement.clientWidth, 105 * data.columns.length),
  }, { displayModeBar: false });

  const drawScatter = () => {
    const [x, y] = [alongX, alongY].map((select) => data.columns[select.value]);
    const best = data.best === null ? [] : [data.best];
    const layout = {
      margin: { l: 60, r: 15, t: 15, b: 50 }, font, height: 420, dragmode: "select", showlegend: false,
      xaxis: { title: { text: x.markup } }, yaxis: { title: { text: y.markup } },
    };
    Plotly.react(scatter, [
      {
        type: "scatter", mode: "markers", x: x.values, y: y.values, text: data.numbers.map((n) => `variant ${n}`),
        marker: { color: data.shades, size: 6, ...look },
        selected: { marker: { opacity: 1 } }, unselected: { marker: { opacity: 0.08 } },
      },
      {
        type: "scatter", mode: "markers", x: best.map((i) => x.values[i]), y: best.map((i) => y.values[i]),
        hoverinfo: "skip", marker: { symbol: "star", size: 15, color: "#d55e00", line: { width: 1, color: "black" } },
      },
    ], layout, settings);
  };

  const within = (value, range) =>
    !range || (Array.isArray(range[0]) ? range : [range]).some(([low, high]) => low <= value && value <= high);
  const fromAcross = (changes) => {
    if (!changes || !Object.keys(changes[0]).some((key) => key.includes("constraintrange"))) return;
    const ranges = across.data[0].dimensions.map((dimension) => dimension.constraintrange);
    const asked = ranges.some(Boolean);
    const rows = everyone.filter((i) => ranges.every((range, k) => within(data.columns[k].values[i], range)));
    Plotly.restyle(scatter, { selectedpoints: [asked ? rows : null] }, [0]);
    tell(asked ? rows : null);
  };
  const fromScatter = (event) => {
    const rows = event ? event.points.filter((p) => p.curveNumber === 0).map((p) => p.pointIndex) : null;
    drawAcross().then(() => Plotly.restyle(across, { "line.color": [rows ? shadesOf(rows) : data.shades] }));
    across.on("plotly_restyle", fromAcross);
    tell(rows);
  };

  data.columns.forEach((column, i) => {
    alongX.add(new Option(column.label, i));
    alongY.add(new Option(column.label, i));
  });
  [alongX.value, alongY.value] = data.axes;
  drawAcross();
  across.on("plotly_restyle", fromAcross);
  drawScatter();
  scatter.on("plotly_selected", (event) => event && fromScatter(event));
  scatter.on("plotly_deselect", () => fromScatter(null));
  [alongX, alongY].forEach((select) => select.addEventListener("change", () => { drawScatter(); }));
  document.getElementById("clear").addEventListener("click", () => { drawScatter(); Plotly.restyle(scatter, { selectedpoints: [null] }, [0]); fromScatter(null); });
})();
