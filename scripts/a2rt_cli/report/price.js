"use strict";
const svg = document.getElementById("scatter");
const detail = document.getElementById("detail");
const chooser = document.getElementById("workload");
const frame = { left: 78, right: 625, top: 12, bottom: 370 };

function make(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

function ticks(low, high) {
  const raw = (high - low) / 5;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((m) => m * power >= raw) * power;
  const out = [];
  for (let v = Math.ceil(low / step) * step; v <= high + step * 1e-9; v += step) out.push(v);
  return out;
}

function extent(values) {
  const low = Math.min(...values), high = Math.max(...values);
  const margin = (high - low || Math.abs(high) || 1) * 0.08;
  return [Math.max(0, low - margin), high + margin];
}

function short(value) {
  return value >= 1e6 ? (value / 1e6).toPrecision(3) + " M" : value.toLocaleString("en");
}

function show(point) {
  const lines = [
    ["configuration", point.label],
    ["redundant", (point.x * 100).toPrecision(3) + " %"],
    [point.axis, point.y.toLocaleString("en")],
    ["lost hits", point.lost === null ? "–" : point.lost.toLocaleString("en")],
  ];
  detail.replaceChildren();
  for (const [key, value] of lines) {
    const row = document.createElement("div");
    const bold = document.createElement("b");
    bold.textContent = value;
    row.append(key + ": ", bold);
    detail.append(row);
  }
  for (const [file, words] of [
    [point.picture, "what this unit draws"],
    [point.difference, `changed pixels: ${point.changed}`],
  ]) {
    if (!file || !pictures[file]) continue;
    const image = document.createElement("img");
    image.src = pictures[file];
    image.alt = words;
    const caption = document.createElement("div");
    caption.className = "note";
    caption.textContent = words;
    detail.append(image, caption);
  }
}

function drawAxes(x, y, xs, ys, name) {
  for (const v of ticks(...ys)) {
    svg.append(make("line", { x1: frame.left, x2: frame.right, y1: y(v), y2: y(v) }));
    svg.append(make("text", { x: frame.left - 8, y: y(v) + 4, "text-anchor": "end", class: "t" }, short(v)));
  }
  for (const v of ticks(...xs)) {
    const text = (v * 100).toPrecision(2) + " %";
    svg.append(make("text", { x: x(v), y: frame.bottom + 18, "text-anchor": "middle", class: "t" }, text));
  }
  const middle = (frame.left + frame.right) / 2;
  svg.append(make("text", { x: middle, y: frame.bottom + 40, "text-anchor": "middle", class: "t b" },
    "redundant hits, share of true misses (left is better)"));
  svg.append(make("text", { x: 14, y: 190, class: "t b", transform: "rotate(-90 14 190)", "text-anchor": "middle" },
    name + " (lower is better)"));
}

function drawPoint(point, x, y) {
  const group = make("g", { class: "point", tabindex: 0, role: "button" });
  const at = { cx: x(point.x), cy: y(point.y) };
  const fill = colours[point.unit];
  if (point.front) group.append(make("circle", { ...at, r: 9, fill: "none", stroke: fill, "stroke-width": 2 }));
  if (point.lost) {
    const d = `M${at.cx - 5},${at.cy - 5}l10,10m0,-10l-10,10`;
    group.append(make("path", { d, stroke: fill, "stroke-width": 2.5, fill: "none" }));
  } else {
    group.append(make("circle", { ...at, r: 5, fill }));
  }
  group.append(make("title", {}, `${point.label}\n${point.axis}: ${point.y.toLocaleString("en")}`));
  group.addEventListener("click", () => show(point));
  group.addEventListener("keydown", (event) => { if (event.key === "Enter") show(point); });
  svg.append(group);
}

function draw() {
  const chosen = points.filter((point) => point.workload === chooser.value);
  while (svg.lastChild && svg.lastChild.nodeName !== "title") svg.lastChild.remove();
  if (!chosen.length) return;
  const xs = extent(chosen.map((p) => p.x)), ys = extent(chosen.map((p) => p.y));
  const x = (v) => frame.left + ((v - xs[0]) / (xs[1] - xs[0])) * (frame.right - frame.left);
  const y = (v) => frame.bottom - ((v - ys[0]) / (ys[1] - ys[0])) * (frame.bottom - frame.top);
  drawAxes(x, y, xs, ys, chosen[0].axis);
  for (const point of chosen) drawPoint(point, x, y);
  const best = chosen.find((p) => p.front && p.unit === "a2rt") || chosen.find((p) => p.front);
  if (best) show(best);
}

chooser.addEventListener("change", draw);
draw();
