"use strict";

/** How many numbers `Viewer.points` gives for each point. */
const COLUMNS = 13;
/** A table of more rows is of no use, and slow. */
const MOST_ROWS = 2000;
/** With more points the object follows when the slider is let go, not while it moves. */
const MOST_LIVE = 4000;

const part = (id) => document.getElementById(id);
const fixed = (number, digits) => (Number.isFinite(number) ? number.toFixed(digits) : "");

/** An element with a text and attributes. Texts of the data go in here alone: as text, never as markup. */
function element(name, text, attributes = {}) {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** The WebAssembly lies in the page as the base64 of a deflated module. */
async function loadCore() {
  const packed = Uint8Array.from(atob(part("snellius-wasm").textContent.trim()), (letter) => letter.charCodeAt(0));
  const inflated = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  await wasm_bindgen({ module_or_path: await new Response(inflated).arrayBuffer() });
}

function complain(text) {
  const problem = part("problem");
  problem.textContent = text;
  problem.hidden = false;
  document.body.dataset.state = "failed";
}

/** The colours of viridis, and a place between them. */
const VIRIDIS = [0x440154, 0x46327e, 0x365c8d, 0x277f8e, 0x1fa187, 0x4ac16d, 0xa0da39, 0xfde725].map((hex) => [
  (hex >> 16) / 255,
  ((hex >> 8) & 255) / 255,
  (hex & 255) / 255,
]);
function viridis(fraction) {
  const place = Math.max(0, Math.min(1, fraction)) * (VIRIDIS.length - 1);
  const step = Math.min(Math.floor(place), VIRIDIS.length - 2);
  return VIRIDIS[step].map((low, i) => low + (VIRIDIS[step + 1][i] - low) * (place - step));
}

/** A colour of the style sheet, as the graphics card takes it. */
function styled(name, alpha = 1) {
  const hex = parseInt(getComputedStyle(document.documentElement).getPropertyValue(name).trim().slice(1), 16);
  return [(hex >> 16) / 255, ((hex >> 8) & 255) / 255, (hex & 255) / 255, alpha];
}

/** What the colours can mean: its name, its unit, the value of a point. */
const COLOURS = [
  ["ray distance", "mm", (point) => point.distance],
  ["standard deviation", "mm", (point) => Math.hypot(...point.sigma)],
  ["scan", "", (point) => point.sweep + 1],
];

/** The page once its data is open. */
class Page {
  constructor(viewer) {
    this.viewer = viewer;
    this.ids = viewer.viewIds();
    this.bent = true;
    this.colour = 0;
    this.picked = [];
    this.chosen = undefined;
    this.facts = JSON.parse(viewer.facts());
    this.say();
    part("main").hidden = false;
    try {
      this.scene = new Scene(part("scene"), Array.from(viewer.sides()));
    } catch {
      part("scene").hidden = true;
      part("no-graphics").hidden = false;
    }
    this.listen();
    this.drawCurve();
    this.refresh();
    this.drawWall();
    this.fit();
  }

  /** What does not change. */
  say() {
    const { facts } = this;
    document.title = facts.title;
    document.querySelector("h1").textContent = facts.title;
    part("notes").textContent = facts.notes;
    part("made").textContent = `Made with Snellius ${facts.program}. Scan: ${facts.scan}`;
    part("warnings").replaceChildren(...facts.warnings.map((warning) => element("li", warning)));
    part("colour").replaceChildren(...COLOURS.map(([name], number) => element("option", name, { value: number })));
  }

  /** The index that is shown. */
  get index() {
    return Number(part("index-number").value);
  }

  listen() {
    const { facts, scene } = this;
    const [slider, number] = [part("index"), part("index-number")];
    const start = facts.measuredIndex ?? 1.333;
    [slider.value, number.value] = [start, Number(start.toFixed(5))];
    for (const control of [slider, number, part("index-reset")]) control.disabled = facts.fixed !== null;
    const live = () => this.points.length <= MOST_LIVE;
    slider.addEventListener("input", () => {
      number.value = slider.value;
      if (live()) this.setIndex();
    });
    slider.addEventListener("change", () => this.setIndex());
    number.addEventListener("input", () => {
      if (!number.checkValidity() || number.value === "") return;
      slider.value = number.value;
      this.setIndex();
    });
    part("index-reset").addEventListener("click", () => {
      [slider.value, number.value] = [start, Number(start.toFixed(5))];
      this.viewer.reset();
      this.refresh();
    });
    part("colour").addEventListener("change", (event) => {
      this.colour = Number(event.target.value);
      this.drawPoints();
    });
    part("bent").addEventListener("change", (event) => {
      this.bent = event.target.checked;
      this.drawPoints();
    });
    part("measure-what").addEventListener("change", () => this.measure());
    part("measure-clear").addEventListener("click", () => {
      this.picked = [];
      this.pickedChanged();
    });
    for (const button of document.querySelectorAll("[data-format]"))
      button.addEventListener("click", () => this.save(button.dataset.format, button.dataset.name));
    part("rows").addEventListener("click", (event) => {
      const row = event.target.closest("tr");
      if (!row?.dataset.point) return;
      const point = Number(row.dataset.point);
      if (event.target.closest("button")) this.pick(point);
      else this.choose(point);
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.drawPoints();
      this.drawWall();
    });
    if (!scene) return;
    scene.onPick = (point) => {
      if (point === undefined) return;
      this.choose(point);
      this.pick(point);
    };
    part("fit").addEventListener("click", () => this.fit());
    for (const side of ["front", "side", "above"])
      part(side).addEventListener("click", () => {
        scene.look(side);
        this.fit();
      });
  }

  setIndex() {
    this.viewer.setIndex(this.index);
    this.refresh();
  }

  /** Everything that follows the index. */
  refresh() {
    this.facts = JSON.parse(this.viewer.facts());
    const numbers = this.viewer.points();
    this.points = Array.from({ length: numbers.length / COLUMNS }, (_, point) => {
      const own = Array.from(numbers.subarray(point * COLUMNS, (point + 1) * COLUMNS));
      const [view, index, sweep] = own;
      return { view, index, sweep, place: own.slice(3, 6), sigma: own.slice(6, 9), distance: own[9], straight: own.slice(10) };
    });
    this.sayNumbers();
    this.fillTable();
    this.drawPoints();
    this.measure();
    // Made by the core, which escapes all texts in it.
    part("figures").innerHTML = this.viewer.figures();
    this.markCurve();
    document.body.dataset.state = "done";
  }

  sayNumbers() {
    const { facts } = this;
    const entries = [
      ["Views with a point", `${facts.used} of ${facts.views}`],
      ["Points", String(this.points.length)],
      ["Ray distance on average", facts.meanRayDistance === null ? "" : `${facts.meanRayDistance.toFixed(3)} mm`],
      ["Vessel", `${facts.shape}, wall ${facts.wallThickness} mm`],
      ["Vessel points off the wall", `${facts.wallRms.toFixed(3)} mm RMS`],
      ["Index outside, wall", `${facts.outside}, ${facts.wall}`],
    ];
    const shown = entries.filter(([, value]) => value !== "");
    part("numbers").replaceChildren(...shown.flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
    const measured = facts.measuredIndex;
    const plusMinus = facts.sigma === null ? "" : ` \u00b1 ${facts.sigma.toFixed(4)}`;
    const origin = facts.method === facts.verdict ? facts.method : `${facts.method}, ${facts.verdict}`;
    const found = measured === null ? "The scan does not tell the index." : `Measured with ${Number(measured.toFixed(5))}${plusMinus} (${origin}).`;
    const why = facts.fixed === null ? "" : ` The points cannot follow it here: ${facts.fixed}.`;
    part("index-note").textContent = found + why;
  }

  fillTable() {
    const remarks = this.viewer.remarks();
    const rows = [];
    let next = 0;
    this.ids.forEach((id, view) => {
      if (rows.length >= MOST_ROWS) return;
      if (this.points[next]?.view !== view) rows.push(this.emptyRow(id, remarks[view]));
      for (; this.points[next]?.view === view; next++) if (rows.length < MOST_ROWS) rows.push(this.row(id, next, remarks[view]));
    });
    part("rows").replaceChildren(...rows);
    part("more").hidden = next >= this.points.length && rows.length < MOST_ROWS;
    part("more").textContent = `The first ${MOST_ROWS} rows; all are in the files above.`;
    this.pickedChanged();
  }

  row(id, number, remark) {
    const point = this.points[number];
    const row = element("tr", "", { "data-point": number, "data-testid": `point-${id}-${point.index}` });
    const cells = [id, point.sweep + 1, ...point.place.map((x) => fixed(x, 3)), ...point.sigma.map((s) => fixed(s, 3))];
    const pick = element("td", "");
    pick.append(element("button", "pick", { type: "button", "aria-pressed": "false", "aria-label": `Pick the point of view ${id}` }));
    row.append(pick, ...[...cells, fixed(point.distance, 3), remark].map((text) => element("td", text)));
    return row;
  }

  emptyRow(id, remark) {
    const row = element("tr", "");
    row.append(element("td", ""), element("td", id), ...Array.from({ length: 8 }, () => element("td", "")), element("td", remark));
    return row;
  }

  /** A view's point by itself, whatever the index does to the points before it. */
  find([view, index]) {
    return this.points.findIndex((point) => point.view === view && point.index === index);
  }

  pick(number) {
    const { view, index } = this.points[number];
    const before = this.picked.length;
    this.picked = this.picked.filter((pair) => pair[0] !== view || pair[1] !== index);
    if (this.picked.length === before) this.picked.push([view, index]);
    if (part("measure-what").value === "distance") this.picked = this.picked.slice(-2);
    this.pickedChanged();
  }

  pickedChanged() {
    const picked = new Set(this.picked.map((pair) => this.find(pair)));
    for (const row of part("rows").children)
      row.querySelector("button")?.setAttribute("aria-pressed", String(picked.has(Number(row.dataset.point))));
    this.measure();
    this.drawMarks();
  }

  measure() {
    const what = part("measure-what").value;
    if (this.picked.length === 0) {
      part("measured").textContent = "Pick points in the scene or in the table.";
      return;
    }
    const { value, sigma, why } = JSON.parse(this.viewer.measure(what, Uint32Array.from(this.picked.flat())));
    part("measured").textContent =
      why === undefined ? `${what}: ${value.toFixed(3)} \u00b1 ${sigma.toFixed(3)} mm` : `${this.picked.length} picked; ${why}`;
  }

  choose(number) {
    const { view, index } = this.points[number];
    this.chosen = [view, index];
    for (const row of part("rows").children) row.classList.toggle("chosen", Number(row.dataset.point) === number);
    this.drawMarks();
  }

  save(format, name) {
    let bytes;
    try {
      bytes = this.viewer.write(format);
    } catch (error) {
      return complain(`${name} cannot be written: ${error.message}`);
    }
    const link = element("a", "", { href: URL.createObjectURL(new Blob([bytes])), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }

  /** Where a point is drawn. */
  shown(point) {
    return this.bent || !Number.isFinite(point.straight[0]) ? point.place : point.straight;
  }

  drawPoints() {
    const [name, unit, value] = COLOURS[this.colour];
    const values = this.points.map(value).filter(Number.isFinite);
    const [low, high] = values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
    this.sayLegend(name, unit, low, high);
    if (!this.scene) return;
    const places = this.points.map((point) => this.shown(point));
    const colours = this.points.flatMap((point) => [...viridis((value(point) - low) / (high - low || 1)), 1]);
    this.scene.background = styled("--ground").slice(0, 3);
    this.scene.setPlaces(places);
    this.scene.set("object", "points", places.flat(), colours, this.points.length > 3000 ? 4 : 9);
    this.drawMarks();
  }

  sayLegend(name, unit, low, high) {
    const ramp = `linear-gradient(90deg, ${VIRIDIS.map((c) => `rgb(${c.map((x) => Math.round(255 * x)).join(" ")})`).join(", ")})`;
    const bar = element("i", "");
    bar.style.background = ramp;
    const digits = unit === "" ? 0 : 3;
    part("legend").replaceChildren(`${fixed(low, digits)}`, bar, `${fixed(high, digits)} ${unit}`);
    part("legend").title = name;
  }

  drawMarks() {
    if (!this.scene) return;
    const picked = this.picked.map((pair) => this.points[this.find(pair)]).filter(Boolean);
    const chosen = this.chosen && this.points[this.find(this.chosen)];
    const marked = [...picked, ...(chosen ? [chosen] : [])];
    const colours = [...picked.flatMap(() => styled("--accent")), ...(chosen ? styled("--mark") : [])];
    this.scene.set("marks", "points", marked.flatMap((point) => this.shown(point)), colours, 18);
    const light = chosen && this.bent ? Array.from(this.viewer.light(...this.chosen)) : [];
    const beam = light.slice(1, 1 + 3 * (light[0] ?? 0));
    const sight = light.slice(1 + beam.length);
    const [red, green] = [segments(beam), segments(sight)];
    const tint = (places, colour) => Array.from({ length: places.length / 3 }, () => colour).flat();
    this.scene.set("light", "lines", [...red, ...green], [...tint(red, styled("--beam")), ...tint(green, styled("--sight"))]);
  }

  /** The wall: its outer face one sees through, and the edges of both faces. */
  drawWall() {
    if (!this.scene) return;
    const [columns, rows, ...numbers] = this.viewer.wall();
    const node = (column, row, face) => numbers.slice(6 * (row * columns + column) + 3 * face).slice(0, 3);
    const whole = (places) => places.flat().every(Number.isFinite);
    const [faces, edges] = [[], []];
    for (let row = 0; row + 1 < rows; row++)
      for (let column = 0; column + 1 < columns; column++)
        for (const face of [0, 1]) {
          const [a, b, c, d] = [node(column, row, face), node(column + 1, row, face), node(column + 1, row + 1, face), node(column, row + 1, face)];
          if (!whole([a, b, c, d])) continue;
          faces.push(...a, ...b, ...c, ...a, ...c, ...d);
          if (row === 0) edges.push(...a, ...b);
          if (row === rows - 2) edges.push(...d, ...c);
          if (column === 0) edges.push(...a, ...d);
          if (column === columns - 2) edges.push(...b, ...c);
        }
    const tint = (places, colour) => Array.from({ length: places.length / 3 }, () => colour).flat();
    this.scene.set("wall", "triangles", faces, tint(faces, styled("--wall", 0.12)));
    this.scene.set("edges", "lines", edges, tint(edges, styled("--wall", 0.7)));
    const vessel = Array.from(this.viewer.vesselPoints());
    this.scene.set("vessel", "points", vessel, tint(vessel, styled("--soft", 0.8)), 4);
  }

  fit() {
    if (!this.scene) return;
    const vessel = this.viewer.vesselPoints();
    const wall = Array.from({ length: vessel.length / 3 }, (_, i) => Array.from(vessel.subarray(3 * i, 3 * i + 3)));
    this.scene.fit([...this.points.map((point) => point.place), ...wall]);
  }

  /** The mean ray distance against the index: eq. (3). */
  drawCurve() {
    const indices = Float64Array.from({ length: 61 }, (_, i) => 1 + (0.8 * i) / 60);
    const few = this.viewer.points().length / COLUMNS <= MOST_LIVE;
    const means = this.facts.isLine || !few ? [] : Array.from(this.viewer.meanRayDistances(indices));
    const known = means.filter(Number.isFinite);
    if (known.length < 3) return;
    const top = Math.max(...known) * 1.05 || 1;
    const [x, y] = [(n) => 34 + ((n - 1) / 0.8) * 270, (mean) => 100 - (mean / top) * 90];
    const line = means.flatMap((mean, i) => (Number.isFinite(mean) ? [`${x(indices[i]).toFixed(1)},${y(mean).toFixed(1)}`] : []));
    const ticks = [1, 1.2, 1.4, 1.6, 1.8].map((n) => `<text x="${x(n)}" y="114" text-anchor="middle">${n}</text>`);
    part("curve").innerHTML = `<svg viewBox="0 0 320 132" role="img" aria-label="Mean ray distance against the index">
      <path class="axis" d="M34 10V100H304" /><polyline class="means" points="${line.join(" ")}" /><line id="now" class="now" y1="10" y2="100" />
      ${ticks.join("")}<text x="30" y="16" text-anchor="end">${top.toPrecision(2)}</text><text x="30" y="103" text-anchor="end">0</text>
      <text x="169" y="128" text-anchor="middle">mean ray distance (mm) against n</text></svg>`;
    this.curveX = x;
  }

  markCurve() {
    const now = part("now");
    if (!now) return;
    const at = this.curveX(Math.max(1, Math.min(1.8, this.index))).toFixed(1);
    now.setAttribute("x1", at);
    now.setAttribute("x2", at);
  }
}

/** A chain of places as separate segments. */
function segments(places) {
  const pairs = [];
  for (let at = 0; at + 6 <= places.length; at += 3) pairs.push(...places.slice(at, at + 6));
  return pairs;
}

async function start() {
  const data = part("snellius-data");
  if (!data) return complain("This page holds no reconstruction: it was made without one, or was cut off.");
  await loadCore();
  window.page = new Page(new wasm_bindgen.Viewer(data.textContent));
}

start().catch((error) => complain(`This page cannot be shown: ${error.message}`));
