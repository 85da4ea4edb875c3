"use strict";
const byId = (id) => document.getElementById(id);
const svg = byId("scatter"), detail = byId("detail"), tip = byId("tip");
const choosers = { scene: byId("scene"), x: byId("x-axis"), y: byId("y-axis") };
const frame = { left: 84, right: 684, top: 14, bottom: 414 };

function make(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

// 1, 2 and 5 times the powers of ten in [low, high]; on a short range evenly spaced values.
function ticks(low, high) {
  const out = [];
  if (low > 0 && high / low < 4) {
    const raw = (high - low) / 4, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].find((m) => m * power >= raw) * power;
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) out.push(v);
    return out;
  }
  if (low <= 0) out.push(0);
  const first = Math.floor(Math.log10(low > 0 ? low : high / 200));
  for (let e = first; e <= Math.log10(high); ++e)
    for (const m of [1, 2, 5]) if (m * 10 ** e >= low && m * 10 ** e <= high) out.push(m * 10 ** e);
  return out;
}

// Wrongness may be 0 and spreads widely: the square root keeps both ends apart. Prices are ratios.
const scales = { x: Math.sqrt, y: Math.log };

function placed(values, scale, from, to) {
  const ends = [Math.min(...values), Math.max(...values)].map(scale);
  const room = (ends[1] - ends[0] || Math.abs(ends[1]) || 1) * 0.06;
  const low = scale === Math.sqrt ? Math.max(0, ends[0] - room) : ends[0] - room, high = ends[1] + room;
  const back = scale === Math.sqrt ? (v) => v * v : Math.exp;
  return { at: (v) => from + ((scale(v) - low) / (high - low)) * (to - from), range: [back(low), back(high)] };
}

function written(value, kind) {
  if (value === null || value === undefined) return "–";
  if (kind === "percent") return Number((value * 100).toPrecision(3)) + "\u00a0%";
  if (kind === "ratio") return (value * 100).toFixed(1) + "\u00a0%";
  if (kind === "small") return String(Number(value.toPrecision(2)));
  if (value >= 1e12) return (value / 1e12).toPrecision(3) + " T";
  if (value >= 1e9) return (value / 1e9).toPrecision(3) + " G";
  return value >= 1e6 ? (value / 1e6).toPrecision(3) + " M" : Math.round(value).toLocaleString("en");
}

// A configuration on all scenes: wrongness averaged (counts summed), prices as the geometric mean
// of the ratios to the A2RT unit as configured.
function averaged(x, y) {
  const scenes = new Set(points.map((p) => p.workload));
  const own = new Map(points.filter((p) => p.unit === "a2rt" && p.default).map((p) => [p.workload, p]));
  const groups = new Map();
  for (const point of points) {
    if (!groups.has(point.label)) groups.set(point.label, []);
    groups.get(point.label).push(point);
  }
  const out = [];
  for (const members of groups.values()) {
    const whole = members.length === scenes.size && members.every((p) => p[x] !== null && p[y] !== null && own.get(p.workload));
    if (!whole) continue;
    const sum = members.reduce((total, p) => total + p[x], 0);
    const logs = members.reduce((total, p) => total + Math.log(p[y] / own.get(p.workload)[y]), 0);
    const lost = members.reduce((total, p) => total + (p.lost || 0), 0);
    out.push({ ...members[0], lost, members, at: [x === "lost" ? sum : sum / members.length, Math.exp(logs / members.length)] });
  }
  return out;
}

function chosenPoints() {
  const x = choosers.x.value, y = choosers.y.value, scene = choosers.scene.value;
  if (scene === everything) return averaged(x, y);
  return points
    .filter((p) => p.workload === scene && p[x] !== null && p[y] !== null)
    .map((p) => ({ ...p, members: [p], at: [p[x], p[y]] }));
}

function frontOf(list) {
  const order = [...list].sort((a, b) => a.at[0] - b.at[0] || a.at[1] - b.at[1]);
  const front = new Set();
  let best = Infinity;
  for (const point of order) if (point.at[1] < best) { front.add(point); best = point.at[1]; }
  return front;
}

function kinds() {
  const ratio = choosers.scene.value === everything;
  return { x: axes.x[choosers.x.value][1], y: ratio ? "ratio" : axes.y[choosers.y.value][1] };
}

function line(key, value) {
  const row = document.createElement("div"), bold = document.createElement("b");
  bold.textContent = value;
  row.append(key + ": ", bold);
  return row;
}

function picture(file, words) {
  if (!file || !pictures[file]) return [];
  const box = document.createElement("div"), image = document.createElement("img");
  image.src = pictures[file];
  image.alt = words;
  const caption = document.createElement("div");
  caption.className = "note";
  caption.textContent = words;
  box.append(image, caption);
  return [box];
}

function show(point) {
  for (const group of svg.querySelectorAll(".point")) group.classList.toggle("chosen", group.dataset.label === point.label);
  const kind = kinds();
  detail.replaceChildren(
    line("configuration", point.label),
    line(axes.x[choosers.x.value][0], written(point.at[0], kind.x)),
    line(axes.y[choosers.y.value][0] + (kind.y === "ratio" ? ", of A²RT's default" : ""), written(point.at[1], kind.y)),
    line("lost hits", point.lost === null ? "–" : point.lost.toLocaleString("en")),
  );
  // Of several scenes those that changed most say most.
  const members = [...point.members].sort((a, b) => (b.changed || 0) - (a.changed || 0)).slice(0, 2);
  for (const one of members) {
    const pair = document.createElement("div");
    pair.className = "pair";
    const words = one.changed ? `${one.workload}: what it draws (${one.passes} passes)` : `${one.workload}: the driver's picture, unchanged`;
    pair.append(...picture(one.picture, words), ...picture(one.difference, `changed pixels: ${one.changed}`));
    detail.append(pair);
  }
}

function drawAxes(x, y, xs, ys) {
  const kind = kinds();
  for (const v of ticks(...ys)) {
    svg.append(make("line", { x1: frame.left, x2: frame.right, y1: y(v), y2: y(v) }));
    svg.append(make("text", { x: frame.left - 8, y: y(v) + 4, "text-anchor": "end", class: "t" }, written(v, kind.y)));
  }
  let last = -Infinity;
  for (const v of ticks(...xs)) {
    if (x(v) - last < 42) continue; // the square root crowds small values
    last = x(v);
    svg.append(make("text", { x: x(v), y: frame.bottom + 18, "text-anchor": "middle", class: "t" }, written(v, kind.x)));
  }
  const middle = (frame.left + frame.right) / 2, half = (frame.top + frame.bottom) / 2;
  svg.append(make("text", { x: middle, y: frame.bottom + 42, "text-anchor": "middle", class: "t b" }, axes.x[choosers.x.value][0]));
  const price = axes.y[choosers.y.value][0] + (kind.y === "ratio" ? ", of A²RT's default" : "");
  svg.append(make("text", { x: 14, y: half, class: "t b", transform: `rotate(-90 14 ${half})`, "text-anchor": "middle" }, price));
}

function hint(point, x, y) {
  const kind = kinds();
  tip.textContent = `${point.label}\n${written(point.at[0], kind.x)} · ${written(point.at[1], kind.y)}` +
    (point.lost ? `\nloses ${point.lost.toLocaleString("en")} hits` : "");
  tip.style.left = `${(x / 700) * 100}%`;
  tip.style.top = `${(y / 470) * 100}%`;
  tip.style.transform = `translate(${x > 480 ? "calc(-100% - 12px)" : "12px"}, -50%)`;
  tip.hidden = false;
}

function drawPoint(point, x, y, onFront) {
  const group = make("g", { class: "point", tabindex: 0, role: "button", "data-label": point.label, "aria-label": point.label });
  const cx = x(point.at[0]), cy = y(point.at[1]), fill = colours[point.unit];
  if (onFront) group.append(make("circle", { cx, cy, r: 9, fill: "none", stroke: fill, "stroke-width": 2 }));
  if (point.lost) {
    const d = `M${cx - 5},${cy - 5}l10,10m0,-10l-10,10`;
    group.append(make("path", { d, class: "dot", stroke: fill, "stroke-width": 2.5, fill: "none" }));
  } else {
    group.append(make("circle", { cx, cy, r: point.default ? 7 : 4.5, class: "dot", fill, "fill-opacity": point.default ? 1 : 0.75 }));
  }
  group.append(make("circle", { cx, cy, r: 10, fill: "transparent" }));
  if (point.default) group.append(make("text", { x: cx, y: cy + (point.unit === "a2rt-literal" ? 22 : -12), "text-anchor": "middle", class: "t b halo" }, point.unit));
  for (const kind of ["mouseenter", "focus"]) group.addEventListener(kind, () => hint(point, cx, cy));
  for (const kind of ["mouseleave", "blur"]) group.addEventListener(kind, () => { tip.hidden = true; });
  group.addEventListener("click", () => show(point));
  group.addEventListener("keydown", (event) => { if (event.key === "Enter") show(point); });
  svg.append(group);
}

function draw() {
  for (const block of document.querySelectorAll("[data-scope]")) block.hidden = block.dataset.scope !== choosers.scene.value;
  while (svg.lastChild && svg.lastChild.nodeName !== "title") svg.lastChild.remove();
  const chosen = chosenPoints();
  svg.dataset.points = chosen.length;
  if (!chosen.length) return;
  const across = placed(chosen.map((p) => p.at[0]), scales.x, frame.left, frame.right);
  const up = placed(chosen.map((p) => p.at[1]), scales.y, frame.bottom, frame.top);
  const x = across.at, y = up.at;
  drawAxes(x, y, across.range, up.range);
  const front = frontOf(chosen);
  // Units as configured lie on top, where they can be pointed at.
  chosen.sort((a, b) => a.default - b.default);
  for (const point of chosen) drawPoint(point, x, y, front.has(point));
  show(chosen.find((p) => p.default && p.unit === "a2rt") || chosen[0]);
}

for (const chooser of Object.values(choosers)) chooser.addEventListener("change", draw);
draw();
