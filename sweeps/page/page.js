// Shared by the page's figures: their data, and the page's state, which is kept in its address.
const page = (() => {
  const state = new URLSearchParams(location.hash.slice(1));
  // A link pasted into an open page, and the back button, show the state in the address.
  addEventListener("hashchange", () => location.reload());
  return {
    data: (id) => JSON.parse(document.getElementById(id)?.textContent ?? "null"),
    state: (key) => state.get(key) ?? "",
    keep(key, value) {
      if (value === "") state.delete(key);
      else state.set(key, value);
      try {
        history.replaceState(null, "", `#${state}`);
      } catch {
        // Inside another page, such as a notebook, this one has no address.
      }
    },
    drawn(parent, kind, attributes = {}, text = "") {
      const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
      Object.entries(attributes).forEach(([name, value]) => made.setAttribute(name, value));
      made.textContent = text;
      parent.append(made);
      return made;
    },
    added(parent, kind, text = "", name = "") {
      const made = document.createElement(kind);
      made.textContent = text;
      made.className = name;
      parent.append(made);
      return made;
    },
    // Digits as on the rest of the page.
    figure: (value) => (value === null ? "–" : String(Number(value.toPrecision(5))).replace("-", "\u2212")),
    // Round numbers within a range, about `count` of them.
    ticks(low, high, count) {
      const rough = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(rough));
      const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough);
      const first = Math.ceil(low / step), last = Math.floor(high / step + 1e-9);
      return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
    },
    shown: new EventTarget(),
  };
})();
