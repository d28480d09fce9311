// The machine in motion: its drawing, with paths and arrows, and its curves with a mark that moves along.
(() => {
  const data = page.data("motion");
  if (!data) return;
  document.body.classList.add("moving");
  const byId = (id) => document.getElementById(id);
  const [slider, play, pace, place, machines] = ["position", "play", "pace", "place", "machines"].map(byId);
  const { axis, closed } = data.machines[0], [axisWords, axisUnit] = axis.label.split(/, (?=[^,]*$)/);
  const colours = { velocity: "#009e73", acceleration: "#cc79a7", loads: "#0072b2", "joint forces": "#d55e00" };

  // Values at a share of the motion, from a row over the motion or a single constant entry of `size` numbers.
  const at = (row, share, size) => {
    if (row.length === size) return row;
    const along = share * (row.length / size - 1), k = Math.min(Math.floor(along), row.length / size - 2), part = along - k;
    return Array.from({ length: size }, (_, i) => {
      const [before, after] = [row[k * size + i], row[(k + 1) * size + i]];
      return before === null || after === null ? null : before + part * (after - before);
    });
  };
  const joined = (flat) => flat.join(" ");

  const figure = (parent, shape, axes) => {
    const { ink, ...stroke } = data.looks.layers[shape.layer] ?? {}, solid = shape.fill === "solid";
    const look = {
      ...stroke, stroke: ink, fill: solid ? ink : data.looks.fills[shape.fill], "vector-effect": "non-scaling-stroke",
      "stroke-linejoin": "round", "stroke-linecap": "butt", ...(solid && { "stroke-dasharray": "none" }),
    };
    const lettered = { "font-size": shape.size, "text-anchor": "middle", "dominant-baseline": "central", class: "name" };
    const kind = { line: "polyline" }[shape.kind] ?? shape.kind;
    const made = page.drawn(parent, kind, shape.kind === "text" ? lettered : look, shape.text);
    const put = (flat) => {
      made.setAttribute("visibility", flat ? "visible" : "hidden");
      if (!flat) return;
      const keys = { circle: ["cx", "cy"], text: ["x", "y"] }[shape.kind];
      if (keys) keys.forEach((key, i) => made.setAttribute(key, flat[i]));
      else made.setAttribute("points", joined(flat));
    };
    if (shape.kind === "circle") made.setAttribute("r", shape.size);
    if (shape.at) put(shape.at);
    return (share) => {
      if (shape.places) {
        const along = share * (shape.places.length - 1), k = Math.min(Math.floor(along), shape.places.length - 2);
        const [before, after] = [shape.places[k], shape.places[k + 1]];
        put(before && after ? before.map((value, i) => value + (along - k) * (after[i] - value)) : before ?? after);
      } else {
        const { at: origin, turn } = axes[shape.on];
        made.setAttribute("transform", `translate(${joined(at(origin, share, 2))}) rotate(${at(turn, share, 1)})`);
      }
    };
  };

  const arrow = (parent, item, kind, tip) => {
    const made = page.drawn(parent, "g", { stroke: colours[kind], fill: colours[kind] });
    const shaft = page.drawn(made, "line", { "vector-effect": "non-scaling-stroke", "stroke-width": 2 });
    const head = page.drawn(made, "polygon", { stroke: "none" });
    page.drawn(made, "title", {}, `${kind}: ${item.name}`);
    return (share) => {
      const [x, y] = at(item.at, share, 2), [dx, dy] = at(item.by, share, 2), size = Math.hypot(dx, dy);
      const there = x !== null && dx !== null && size > tip / 8;
      made.setAttribute("visibility", there ? "visible" : "hidden");
      if (!there) return;
      const [u, v] = [dx / size, dy / size], long = Math.min(tip, size / 2), [ex, ey] = [x + dx, y + dy];
      Object.entries({ x1: x, y1: y, x2: ex - long * u, y2: ey - long * v }).forEach(([k, value]) => shaft.setAttribute(k, value));
      const [bx, by, half] = [ex - long * u, ey - long * v, 0.35 * long];
      head.setAttribute("points", joined([ex, ey, bx - half * v, by + half * u, bx + half * v, by - half * u]));
    };
  };

  // A curve over the input's position, or one quantity over another.
  const chart = (holder, curve) => {
    const [width, height, left, right, top, bottom] = [340, 190, 52, 10, 8, 34], { x, y } = curve;
    const abscissa = x ?? { ...axis, label: axisWords, unit: axisUnit };
    const finite = (values) => values.filter((value) => value !== null);
    const span = (values) => {
      const [low, high] = [Math.min(...values), Math.max(...values)], room = 0.05 * (high - low) || 0.1 * Math.abs(high) || 1;
      return [low - room, high + room];
    };
    const [lowX, highX] = x ? span(finite(x.values)) : [axis.first, axis.last], [lowY, highY] = span(finite(y.values));
    const toX = (value) => left + ((value - lowX) / (highX - lowX)) * (width - left - right);
    const toY = (value) => top + ((highY - value) / (highY - lowY)) * (height - top - bottom);
    const decimals = Math.min(100, Math.max(0, 4 - Math.floor(Math.log10(highY - lowY))));
    const valueX = (share) => (x ? at(x.values, share, 1)[0] : axis.first + share * (axis.last - axis.first));
    const box = page.added(holder, "figure", "", "chart");
    const words = page.added(box, "figcaption"), unit = y.unit && ` ${y.unit}`;
    const named = `${y.label} over ${abscissa.label}`;
    const svg = page.drawn(box, "svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": named });
    const line = (points, look) => page.drawn(svg, "polyline", { points: joined(points), fill: "none", "stroke-width": 1, ...look });
    const text = (px, py, anchor, value) => page.drawn(svg, "text", { x: px, y: py, "text-anchor": anchor }, value);
    page.ticks(lowY, highY, 5).forEach((value) => {
      line([left, toY(value), width - right, toY(value)], { stroke: value ? "#e3e6e9" : "#8a9096" });
      text(left - 4, toY(value) + 3.5, "end", page.figure(value));
    });
    const degrees = abscissa.unit === "°" && axis.last - axis.first >= 360;
    const uprights = degrees ? [0, 1, 2, 3, 4].map((k) => axis.first + (k * (axis.last - axis.first)) / 4) : page.ticks(lowX, highX, 5);
    uprights.forEach((value) => {
      line([toX(value), top, toX(value), height - bottom], { stroke: "#e3e6e9" });
      text(toX(value), height - bottom + 13, "middle", page.figure(value));
    });
    text(left + (width - left - right) / 2, height - 4, "middle", abscissa.unit ? `${abscissa.label}, ${abscissa.unit}` : abscissa.label);
    let points = [];
    y.values.forEach((value, k) => {
      const across = valueX(k / (y.values.length - 1));
      if (value !== null && across !== null) points.push(toX(across), toY(value));
      if (points.length && (value === null || k === y.values.length - 1)) {
        line(points, { stroke: "#0072b2", "stroke-width": 1.6 });
        points = [];
      }
    });
    const upright = line([], { stroke: "#d55e00", "stroke-dasharray": "4 3" });
    const mark = page.drawn(svg, "circle", { r: 4.5, fill: "#d55e00" });
    return (share) => {
      const across = valueX(share), [value] = at(y.values, share, 1), there = across !== null && value !== null;
      // More digits than the curve has would be rounding.
      const digits = value === null ? null : Number(value.toFixed(decimals));
      words.textContent = `${y.label}: ${page.figure(digits)}${unit}`;
      [upright, mark].forEach((item) => item.setAttribute("visibility", there ? "visible" : "hidden"));
      if (!there) return;
      mark.setAttribute("cx", toX(across));
      mark.setAttribute("cy", toY(value));
      upright.setAttribute("points", joined([toX(across), top, toX(across), height - bottom]));
    };
  };

  // One of several machines; returns the function that shows it at a share of its motion.
  const machine = (content) => {
    const holder = page.added(machines, "section", "", "machine");
    page.added(holder, "h3", content.name);
    const svg = page.drawn(holder, "svg", { role: "img", class: "drawing" });
    const parts = content.figures.map((shape) => figure(svg, shape, content.axes));
    const chosen = page.drawn(svg, "g"), curves = page.added(holder, "div", "", "charts");
    const charts = content.curves.map((curve) => chart(curves, curve));
    let arrows = [];
    const [x, y, width, height] = content.box, size = [width, height].map((length) => length * content.unit);
    return {
      holder, size,
      // Machines next to each other are drawn to one scale [m].
      fit(frame) {
        const [w, h] = frame.map((length) => length / content.unit);
        svg.setAttribute("viewBox", joined([x - (w - width) / 2, y - (h - height) / 2, w, h]));
      },
      choose(points, kinds) {
        chosen.replaceChildren();
        points.filter((name) => content.points[name]).forEach((name) => page.drawn(chosen, "polyline", {
          points: joined(content.points[name]), fill: "none", stroke: "#d55e00", "stroke-width": 1.5,
          "vector-effect": "non-scaling-stroke", class: "path",
        }));
        const asked = content.arrows.filter(({ kind }) => kinds.includes(kind));
        arrows = asked.flatMap(({ kind, items }) => items.map((item) => arrow(chosen, item, kind, content.tip)));
      },
      show(share, words) {
        svg.setAttribute("aria-label", `${content.name} at ${words}`);
        [...parts, ...charts, ...arrows].forEach((part) => part(share));
      },
    };
  };

  const all = [machine(data.machines[0])];
  const value = (share) => axis.first + share * (axis.last - axis.first);
  let share = 0, playing = false, forth = data.machines[0].backwards ? -1 : 1, last = null;
  const words = () => `${axisWords} ${page.figure(Number(value(share).toPrecision(4)))} ${axisUnit}`;
  const show = () => {
    slider.value = value(share);
    slider.setAttribute("aria-valuetext", words());
    place.textContent = words();
    all.forEach((one) => one.show(share, words()));
  };
  const keep = () => page.keep("at", Number(value(share).toPrecision(6)));
  page.shown.addEventListener("leave", keep);

  const step = (now) => {
    if (!playing) return;
    share += (forth * (now - (last ?? now))) / (1000 * pace.value);
    last = now;
    if (closed) share -= Math.floor(share);
    else if (share < 0 || share > 1) [share, forth] = [Math.min(1, Math.max(0, share)), -forth];
    show();
    requestAnimationFrame(step);
  };
  const run = (on) => {
    [playing, last] = [on, null];
    play.textContent = on ? "Pause" : "Play";
    page.keep("play", on ? 1 : "");
    if (on) requestAnimationFrame(step);
    else keep();
  };

  const boxes = (holder, key, names, usual) => {
    const asked = page.state(key) ? page.state(key).split(",") : usual;
    names.forEach(([name, told]) => {
      const label = page.added(holder, "label"), box = page.added(label, "input");
      [box.type, box.value, box.checked] = ["checkbox", name, asked.includes(name)];
      const text = page.added(label, "span", ` ${told}`);
      if (colours[name]) text.style.color = colours[name];
      box.addEventListener("change", () => { choose(); page.keep(key, chosen(holder).join(",")); });
    });
    holder.hidden = !names.length;
  };
  const chosen = (holder) => [...holder.querySelectorAll("input:checked")].map((box) => box.value);
  const choose = () => {
    const frame = [0, 1].map((side) => Math.max(...all.map((one) => one.size[side])));
    all.forEach((one) => one.fit(frame));
    all.forEach((one) => one.choose(chosen(byId("paths")), chosen(byId("arrows"))));
    show();
  };

  [slider.min, slider.max, slider.step] = [axis.first, axis.last, (axis.last - axis.first) / 360];
  slider.setAttribute("aria-label", axisWords);
  slider.addEventListener("input", () => {
    share = (slider.value - axis.first) / (axis.last - axis.first);
    show();
  });
  slider.addEventListener("change", keep);
  play.addEventListener("click", () => run(!playing));
  pace.value = page.state("pace");
  if (!pace.value) pace.value = "4";
  pace.addEventListener("change", () => page.keep("pace", pace.value));
  boxes(byId("paths"), "paths", Object.keys(data.machines[0].points).map((name) => [name, name]), []);
  boxes(byId("arrows"), "arrows", data.machines[0].arrows.map(({ kind, longest }) => [kind, `${kind} (longest ${longest})`]), []);
  const begin = page.state("at") === "" ? data.machines[0].start : Number(page.state("at"));
  share = Math.min(1, Math.max(0, (begin - axis.first) / (axis.last - axis.first))) || 0;
  choose();
  if (page.state("play")) run(true);

  // The machine of a picked variant, next to the first one.
  page.shown.addEventListener("pick", ({ detail }) => {
    all.splice(1).forEach((one) => one.holder.remove());
    const picked = data.machines.slice(1).find(({ number }) => number === detail.number);
    if (picked) all.push(machine(picked));
    byId("undrawn").hidden = detail.number === null || detail.number === data.machines[0].number || Boolean(picked);
    choose();
  });
})();
