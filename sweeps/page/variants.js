// The variants in parallel coordinates, a scatter and a table: selections and the picked variant are shared by all.
(() => {
  const data = page.data("variants");
  if (!data) return;
  document.body.classList.add("linked");
  const byId = (id) => document.getElementById(id);
  const [across, scatter, told, table] = ["across", "scatter", "selected", "compared"].map(byId);
  const [alongX, alongY, variant] = ["along-x", "along-y", "variant"].map(byId);
  const { columns, plotted, numbers, best, goal } = data, everyone = numbers.map((_, i) => i);
  const [grey, orange, ink] = ["#c9cdd1", "#d55e00", "#1d2125"];
  const colour = (i) => (data.shades[i] < 0 ? grey : data.colours[Math.round(data.shades[i] * (data.colours.length - 1))]);
  const reach = columns.map(({ values: some }) => {
    const values = some.filter((value) => value !== null);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return low < high ? [low, high] : [low - 1, high + 1];
  });

  // Ranges by column, and the picked variant.
  const ranges = new Map(), number = numbers.indexOf(Number(page.state("variant") || NaN));
  page.state("ranges").split(";").filter(Boolean).forEach((text) => {
    const [k, low, high] = text.split("_"), end = (one, none) => (one && Number.isFinite(Number(one)) ? Number(one) : none);
    if (columns[k]) ranges.set(Number(k), [end(low, -Infinity), end(high, Infinity)]);
  });
  let picked = number < 0 ? null : number;
  const within = (value, [low, high]) => value !== null && low <= value && value <= high;
  const selected = () => everyone.filter((i) => [...ranges].every(([k, range]) => within(columns[k].values[i], range)));
  let rows = selected();

  const brush = (canvas, width, height) => {
    const ratio = window.devicePixelRatio || 1, context = canvas.getContext("2d");
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    [canvas.style.width, canvas.style.height] = [`${width}px`, `${height}px`];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = "11px system-ui, sans-serif";
    return context;
  };
  const text = (context, words, x, y, align = "center") => {
    [context.fillStyle, context.textAlign] = [ink, align];
    context.fillText(words, x, y);
  };
  // Unselected variants first, those that stand out last.
  const inOrder = (draw) => {
    const there = new Set(rows);
    everyone.filter((i) => !there.has(i)).forEach((i) => draw(i, "#eceef0", false));
    rows.forEach((i) => draw(i, colour(i), false));
    if (best !== null) draw(best, orange, true);
    if (picked !== null) draw(picked, ink, true);
  };

  // Parallel coordinates
  const deepest = Math.max(...plotted.map((k) => columns[k].lines.length)), [top, body] = [26, 280];
  let places = [];
  const height = (k, value) => top + body * (1 - (value - reach[k][0]) / (reach[k][1] - reach[k][0]));
  const valueAt = (k, y) => reach[k][0] + (1 - Math.min(1, Math.max(0, (y - top) / body))) * (reach[k][1] - reach[k][0]);
  const drawAcross = () => {
    const width = Math.max(across.parentElement.clientWidth, 100 * plotted.length);
    const context = brush(across, width, top + body + 40 + 14 * deepest);
    places = plotted.map((_, i) => 60 + (i * (width - 120)) / Math.max(1, plotted.length - 1));
    inOrder((i, ink, stands) => {
      [context.strokeStyle, context.lineWidth, context.globalAlpha] = [ink, stands ? 2.5 : 1, stands ? 1 : 0.6];
      context.beginPath();
      plotted.forEach((k, place) => context.lineTo(places[place], height(k, columns[k].values[i])));
      context.stroke();
    });
    context.globalAlpha = 1;
    plotted.forEach((k, place) => {
      [context.strokeStyle, context.lineWidth] = [ink, 1];
      context.strokeRect(places[place], top, 0, body);
      text(context, page.figure(reach[k][1]), places[place], top - 8);
      text(context, page.figure(reach[k][0]), places[place], top + body + 14);
      columns[k].lines.forEach((words, line) => text(context, words, places[place], top + body + 34 + 14 * line));
      if (!ranges.has(k)) return;
      const [low, high] = ranges.get(k).map((end) => height(k, Math.min(reach[k][1], Math.max(reach[k][0], end))));
      context.fillStyle = "rgb(0 114 178 / 35%)";
      context.fillRect(places[place] - 6, high, 12, Math.max(2, low - high));
    });
  };

  // Scatter
  const [left, right, above, below] = [70, 15, 15, 48], tall = 400;
  let frame = null;
  const drawScatter = () => {
    const [kx, ky] = [Number(alongX.value), Number(alongY.value)], width = scatter.parentElement.clientWidth;
    const context = brush(scatter, width, tall);
    const room = ([low, high]) => [low - 0.04 * (high - low), high + 0.04 * (high - low)];
    const [[x0, x1], [y0, y1]] = [room(reach[kx]), room(reach[ky])], [w, h] = [width - left - right, tall - above - below];
    frame = {
      kx, ky, there: (i) => columns[kx].values[i] !== null && columns[ky].values[i] !== null,
      to: (i) => [left + (w * (columns[kx].values[i] - x0)) / (x1 - x0), above + h * (1 - (columns[ky].values[i] - y0) / (y1 - y0))],
      from: (x, y) => [x0 + ((x - left) / w) * (x1 - x0), y0 + (1 - (y - above) / h) * (y1 - y0)],
    };
    [context.strokeStyle, context.lineWidth] = ["#e3e6e9", 1];
    page.ticks(x0, x1, 6).forEach((value) => {
      const x = left + (w * (value - x0)) / (x1 - x0);
      context.strokeRect(x, above, 0, h);
      text(context, page.figure(value), x, tall - below + 16);
    });
    page.ticks(y0, y1, 6).forEach((value) => {
      const y = above + h * (1 - (value - y0) / (y1 - y0));
      context.strokeRect(left, y, w, 0);
      text(context, page.figure(value), left - 6, y + 4, "right");
    });
    text(context, columns[kx].label, left + w / 2, tall - 8);
    context.save();
    context.translate(14, above + h / 2);
    context.rotate(-Math.PI / 2);
    text(context, columns[ky].label, 0, 0);
    context.restore();
    inOrder((i, ink, stands) => {
      if (!frame.there(i)) return;
      context.fillStyle = ink;
      context.beginPath();
      context.arc(...frame.to(i), stands ? 7 : 3.2, 0, 2 * Math.PI);
      context.fill();
    });
  };

  // The table: the best and the picked variant, and the range of each number
  const cells = columns.map((column, k) => {
    const row = table.tBodies[0].insertRow(), head = page.added(row, "th", column.label);
    head.scope = "row";
    const [ofBest, ofPicked, apart] = ["number", "number", "number"].map((name) => page.added(row, "td", "", name));
    ofBest.textContent = best === null ? "–" : page.figure(column.values[best]);
    const ends = ["at least", "at most"].map((words, end) => {
      const input = page.added(page.added(row, "td"), "input");
      [input.type, input.step] = ["number", "any"];
      input.setAttribute("aria-label", `${column.label}, ${words}`);
      input.addEventListener("change", () => {
        const asked = ranges.get(k) ?? [-Infinity, Infinity];
        asked[end] = input.value === "" ? [-Infinity, Infinity][end] : Number(input.value);
        setRanges([[k, asked]]);
      });
      return input;
    });
    return { ofPicked, apart, ends };
  });
  const tabulate = () => columns.forEach(({ values }, k) => {
    const { ofPicked, apart, ends } = cells[k], [asked, here, there] = [ranges.get(k), values[picked], values[best]];
    ofPicked.textContent = picked === null ? "–" : page.figure(here);
    const share = (100 * (here - there)) / Math.abs(there);
    apart.textContent = picked === null || best === null || here === null || !there ? "" : `${share > 0 ? "+" : ""}${page.figure(Number(share.toFixed(2)))} %`;
    ends.forEach((input, end) => { input.value = asked && Number.isFinite(asked[end]) ? Number(asked[end].toPrecision(6)) : ""; });
  });

  // A variant as text: its numbers in TOML, and the command that writes its scene
  const key = (name) => (/^[\w-]+$/.test(name) ? name : JSON.stringify(name));
  const toml = (i) => {
    const tables = new Map();
    columns.filter(({ exact }) => exact).forEach(({ name, exact, unit }) => {
      const parts = name.split("."), last = parts.pop(), head = parts.map(key).join(".");
      const value = unit === null ? String(exact[i]) : JSON.stringify(`${exact[i]} ${unit}`);
      tables.set(head, [...(tables.get(head) ?? []), `${key(last)} = ${value}`]);
    });
    const told = [...tables].map(([head, lines]) => `${head ? `[${head}]\n` : ""}${lines.join("\n")}\n`);
    return `# variant ${numbers[i]}\n${told.join("\n")}`;
  };
  const copy = (source) => {
    const done = (words) => { byId("copied").textContent = words; };
    const byHand = () => {
      getSelection().selectAllChildren(source);
      done("Press Ctrl+C to copy the selected text.");
    };
    if (navigator.clipboard) navigator.clipboard.writeText(source.textContent).then(() => done("Copied."), byHand);
    else byHand();
  };

  const redraw = () => {
    drawAcross();
    drawScatter();
    tabulate();
  };
  const list = () => {
    variant.replaceChildren(new Option("none", ""), ...rows.map((i) => new Option(`variant ${numbers[i]}: ${page.figure(columns[goal].values[i])}`, i)));
    if (picked !== null && !rows.includes(picked)) variant.add(new Option(`variant ${numbers[picked]}, not selected`, picked));
    variant.value = picked ?? "";
    told.textContent = ranges.size ? `${rows.length} of ${everyone.length} shown variants selected` : "";
  };
  const setRanges = (changes) => {
    changes.forEach(([k, range]) => (range && range.some(Number.isFinite) ? ranges.set(k, range) : ranges.delete(k)));
    page.keep("ranges", [...ranges].map(([k, ends]) => [k, ...ends.map((end) => (Number.isFinite(end) ? Number(end.toPrecision(6)) : ""))].join("_")).join(";"));
    rows = selected();
    list();
    redraw();
  };
  const pick = (i) => {
    picked = i;
    page.keep("variant", i === null ? "" : numbers[i]);
    byId("picked").textContent = i === null ? "picked" : `variant ${numbers[i]}`;
    byId("made").hidden = i === null;
    if (i !== null) {
      byId("toml").textContent = toml(i);
      byId("command").textContent = `sweeps export ${data.file} --variant ${numbers[i]} --to variant_${numbers[i]}.toml`;
    }
    byId("copied").textContent = "";
    list();
    redraw();
    page.shown.dispatchEvent(new CustomEvent("pick", { detail: { number: i === null ? null : numbers[i] } }));
  };
  const nearest = (candidates, away) => {
    const found = candidates.map((i) => [away(i), i]).filter(([d]) => d < 14).sort(([a], [b]) => a - b);
    if (found.length) pick(found[0][1]);
  };
  // Arrow keys step through the selected variants in the order of a column.
  const stepping = (canvas, column) => canvas.addEventListener("keydown", (event) => {
    const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (event.key === "Escape") pick(null);
    if (!by || !rows.length) return;
    event.preventDefault();
    const { values } = columns[column()], order = [...rows].sort((a, b) => values[a] - values[b]);
    const at = order.indexOf(picked ?? best);
    pick(order[at < 0 ? 0 : Math.min(order.length - 1, Math.max(0, at + by))]);
  });

  // Dragging selects, clicking picks
  const dragged = (canvas, started, moved, clicked) => {
    let from = null, far = false;
    const place = (event) => [event.offsetX, event.offsetY];
    canvas.addEventListener("pointerdown", (event) => {
      [from, far] = [place(event), false];
      started(from);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      const to = place(event);
      far ||= Math.hypot(to[0] - from[0], to[1] - from[1]) > 4;
      if (far) moved(from, to);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (from && !far) clicked(place(event));
      from = null;
    });
  };
  let axis = null;
  const axisAt = ([x]) => places.findIndex((place) => Math.abs(place - x) < 14);
  dragged(across, (at) => { axis = axisAt(at); }, ([, from], [, to]) => {
    if (axis >= 0) setRanges([[plotted[axis], [valueAt(plotted[axis], Math.max(from, to)), valueAt(plotted[axis], Math.min(from, to))]]]);
  }, ([x, y]) => {
    if (axis >= 0 && ranges.has(plotted[axis])) return setRanges([[plotted[axis], null]]);
    const before = Math.max(0, places.findLastIndex((place) => place <= x)), after = Math.min(before + 1, places.length - 1);
    const part = after > before ? (x - places[before]) / (places[after] - places[before]) : 0;
    const [low, high] = [plotted[before], plotted[after]];
    nearest(rows, (i) => Math.abs((1 - part) * height(low, columns[low].values[i]) + part * height(high, columns[high].values[i]) - y));
  });
  dragged(scatter, () => {}, (from, to) => {
    const [[xa, ya], [xb, yb]] = [frame.from(...from), frame.from(...to)];
    setRanges([[frame.kx, [Math.min(xa, xb), Math.max(xa, xb)]], [frame.ky, [Math.min(ya, yb), Math.max(ya, yb)]]]);
  }, ([x, y]) => nearest(rows.filter(frame.there), (i) => Math.hypot(frame.to(i)[0] - x, frame.to(i)[1] - y)));
  stepping(across, () => goal);
  stepping(scatter, () => alongX.value);

  [alongX, alongY].forEach((select, i) => {
    select.replaceChildren(...columns.map((column, k) => new Option(column.label, k)));
    select.value = page.state("xy").split("_")[i] || data.axes[i];
    if (!select.value) select.value = data.axes[i];
    select.addEventListener("change", () => {
      page.keep("xy", `${alongX.value}_${alongY.value}`);
      drawScatter();
    });
  });
  variant.addEventListener("change", () => pick(variant.value === "" ? null : Number(variant.value)));
  byId("clear").addEventListener("click", () => setRanges([...ranges.keys()].map((k) => [k, null])));
  byId("copy").addEventListener("click", () => copy(byId("toml")));
  byId("copy-command").addEventListener("click", () => copy(byId("command")));
  addEventListener("resize", redraw);
  pick(picked);
})();
