"use strict";
// Draws the page from its embedded description (src/lab/page.h): sections with tables, charts of their
// columns, and pictures. Colour, symbol and dash together distinguish the series.

const symbols = ["circle", "diamond", "square", "triangle", "plus", "star", "times", "wye"];
const dashes = ["none", "7 3", "2 3", "9 3 2 3", "4 2", "12 3", "1 4", "6 2 1 2 1 2"];
// From the ninth series on, colours repeat with other symbols and dashes.
const seriesStyle = (i) => ({
  colour: `var(--series-${(i % 8) + 1})`, symbol: symbols[(i + 3 * Math.floor(i / 8)) % 8],
  dash: dashes[(i + Math.floor(i / 8)) % 8]
});

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

// Five significant digits are enough to read. data-value and the JSON have the exact value.
function shown(value) {
  if (value === null || value === undefined) return "–";
  if (!isNumber(value)) return String(value);
  if (Number.isInteger(value)) return value.toLocaleString("en");
  const size = Math.abs(value);
  if (size >= 1e4) return Math.round(value).toLocaleString("en");
  return size >= 1e-3 ? String(Number(value.toPrecision(5))) : value.toExponential(2);
}

const cell = (value) =>
  element("td", isNumber(value) ? { "data-value": value } : { class: "text" }, shown(value));

function table(columns, rows) {
  const head = element("tr", {}, ...columns.map((name, i) =>
    element("th", { class: rows.length && !isNumber(rows[0][i]) ? "text" : "", scope: "col" }, name)));
  const body = rows.map((row) => element("tr", {}, ...row.map(cell)));
  const box = element("div", { class: "wide" },
    element("table", {}, element("thead", {}, head), element("tbody", {}, ...body)));
  new ResizeObserver(() => box.classList.toggle("cut", box.scrollWidth > box.clientWidth)).observe(box);
  return box;
}

const problem = (text) => element("p", { class: "problem", role: "alert" }, text);

// results.h counts pictures without an error as 100 dB.
const read = (column, value) => column.endsWith("dB") && value >= 100 ? "equal" : shown(value);

// The series of a section's chart, from the rows of its table. If `chart.by` is empty or has only one value,
// series of several columns have the columns' names.
function seriesOf(section) {
  const chart = section.chart, { columns, rows } = section.numbers ?? section.table;
  const at = (row, name) => name ? row[columns.indexOf(name)] : undefined;
  const groups = [...new Set([...chart.order, ...rows.map((row) => at(row, chart.by))])];
  const positive = (value, log) => isNumber(value) && (!log || value > 0);
  const fits = (p) => (chart.bars ? typeof p.x === "string" : positive(p.x, chart.log_x)) && positive(p.y, chart.log_y);
  const series = groups.flatMap((group) => chart.y.map((column) => {
    const name = chart.y.length === 1 ? group ?? column : groups.length === 1 ? column : `${group}: ${column}`;
    const points = rows.filter((row) => at(row, chart.by) === group).map((row) => ({
      x: at(row, chart.x), y: at(row, column), filled: at(row, chart.filled) === "yes", spread: at(row, chart.spread),
      label: chart.label ? shown(at(row, chart.label)) : "" }));
    const good = points.filter(fits);
    const bad = chart.y.length > 1 ? [] : points.filter((p) => !fits(p) && p.y !== "" && typeof p.x !== "string");
    return { name, column, good, bad, line: chart.line, steps: chart.steps, dots: chart.dots };
  }));
  let best = -Infinity;
  const front = chart.front ? series.flatMap((s) => s.good).filter((p) => p.filled).sort((p, q) => p.x - q.x)
    .filter((p) => p.y > best && ((best = p.y), true)) : [];
  if (front.length) series.push({ name: "Pareto front", good: front, bad: [], line: true, steps: true, dots: false });
  return series.map((s, i) => ({ ...s, style: seriesStyle(i), on: true }));
}

const titleOf = (chart) => chart.title || chart.y[0];

const pointText = (chart, series, p) =>
  [p.label, series.name, `${chart.x}: ${read(chart.x, p.x)}`,
    `${series.column ?? titleOf(chart)}: ${read(titleOf(chart), p.y)}`].filter((line) => line).join("\n");

// Counts have whole ticks: at most `ticks`, between whole numbers. By default the tick of a single value has no digits.
function scale(label, log, values = [], ticks = 10) {
  const [least, most] = d3.extent(values), made = { label, labelArrow: "none", grid: true,
    ...(log ? { type: "log", tickFormat: "~g" } : least === most ? { tickFormat: shown } : {}) };
  if (!/\b(count|frames?|pairs|Gaussians)$/.test(label) || !values.length) return made;
  const domain = [Math.floor(least), Math.ceil(most)];
  return { ...made, domain, ticks: Math.max(1, Math.min(ticks, domain[1] - domain[0])) };
}

// Stacked horizontal bars: names stay readable on a narrow screen.
function bars(chart, chosen, width) {
  const categories = [...new Set(chosen.flatMap((s) => s.good.map((p) => p.x)))];
  const points = chosen.flatMap((s) => s.good.map((p) => ({ ...p, of: s })));
  const longest = 7 * Math.max(1, ...categories.map((name) => name.length)), room = Math.min(longest, width * 0.35);
  const sums = d3.rollup(points, (of) => d3.sum(of, (p) => p.y), (p) => p.x);
  const place = { x: "y", y: "x", z: (p) => p.of.name, order: null };
  return {
    height: 72 + (16 + 14 * Math.ceil(longest / room)) * categories.length, marginLeft: 14 + room,
    insetRight: 8, x: scale(titleOf(chart), false, [0, ...sums.values()], width / 80), y: { domain: categories },
    marks: [
      Plot.axisY({ label: null, lineWidth: room / 12 }),
      Plot.barX(points, Plot.stackX({ ...place, fill: (p) => p.of.style.colour,
        title: (p) => pointText(chart, p.of, p), tip: true, inset: 0.5 })),
      Plot.ruleX([0])
    ]
  };
}

// Pictures of 60 dB or more look equal. They stand at the edge, and the axis belongs to the others. If there are no
// others, only equal pictures stand there.
function edged(axis, values) {
  const cap = values.some((value) => value < 60) ? 60 : 100;
  const good = axis.label.endsWith("dB") ? values.filter((value) => value >= cap) : [];
  if (!good.length) return { axis, at: (value) => value };
  const others = values.filter((value) => value < cap), [least = 0, most = 0] = d3.extent(others);
  const edge = most + 0.15 * (most - least || 1), name = d3.min(good) < 100 ? "≥ 60" : "equal";
  return { at: (value) => value >= cap ? edge : value,
    axis: { ...axis, ticks: [...(others.length ? d3.ticks(least, most, 6) : []), edge],
      tickFormat: (value) => value === edge ? name : shown(value) } };
}

function curves(chart, chosen, width) {
  const marks = [], all = chosen.flatMap((s) => s.good), xs = all.map((p) => p.x), ys = all.map((p) => p.y);
  const x = edged(scale(chart.x, chart.log_x, xs, width / 80), xs);
  const y = edged({ ...scale(titleOf(chart), chart.log_y, ys), zero: chart.zero }, ys);
  const at = { x: (p) => x.at(p.x), y: (p) => y.at(p.y) };
  for (const s of chosen) {
    if (s.line) marks.push(Plot.line(s.good, { ...at, stroke: s.style.colour, strokeWidth: 1.75,
      strokeDasharray: s.style.dash, ...(s.steps ? { curve: "step-after" } : {}) }));
    if (chart.spread && s.dots) marks.push(Plot.ruleY(s.good.filter((p) => p.spread > 0), { y: at.y,
      x1: (p) => p.x - p.spread, x2: (p) => p.x + p.spread, stroke: s.style.colour }));
    if (s.dots) marks.push(Plot.dot(s.good, { ...at, symbol: s.style.symbol, stroke: s.style.colour,
      strokeWidth: 1.75, r: 4, fill: (p) => p.filled ? s.style.colour : "var(--paper)" }));
  }
  const points = chosen.flatMap((s) => s.good.map((p) => ({ ...p, text: pointText(chart, s, p) })));
  marks.push(Plot.tip(points, Plot.pointer({ ...at, title: "text" })));
  return { inset: 6, x: x.axis, y: y.axis, marks };
}

// Stacked areas over a number, the first series at the bottom.
function areas(chart, chosen, width) {
  const points = chosen.flatMap((s) => s.good.map((p) => ({ ...p, of: s })));
  const place = { x: "x", y: "y", z: (p) => p.of.name, order: null };
  return { x: scale(chart.x, false, points.map((p) => p.x), width / 80), y: scale(titleOf(chart), false),
    marks: [
      Plot.areaY(points, Plot.stackY({ ...place, fill: (p) => p.of.style.colour })),
      Plot.tip(points, Plot.pointerX(Plot.stackY({ ...place, title: (p) => pointText(chart, p.of, p) }))),
      Plot.ruleY([0])
    ] };
}

function draw(chart, chosen, width) {
  const options = chart.bars ? bars(chart, chosen, width) : chart.areas ? areas(chart, chosen, width)
    : curves(chart, chosen, width);
  return Plot.plot({ width, height: Math.max(260, Math.min(440, width * 0.55)), marginLeft: 56, marginBottom: 42,
    color: { type: "identity" }, symbol: { type: "identity" }, ...options, x: { ...options.x, labelOffset: 36 },
    style: { background: "none", color: "var(--ink)", fontSize: "12px", fontFamily: "inherit" } });
}

// Saves a standalone copy in the colours of light mode.
function saveSvg(svg, name) {
  const copy = svg.cloneNode(true);
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.querySelectorAll('[aria-label="tip"]').forEach((tip) => tip.remove());
  const colours = document.getElementById("style").textContent.match(/:root \{[^}]*\}/)[0];
  const style = document.createElementNS("http://www.w3.org/2000/svg", "style");
  style.textContent = `${colours} svg { background: #ffffff; font-family: sans-serif; }`;
  copy.prepend(style);
  save(new XMLSerializer().serializeToString(copy), `${name}.svg`, "image/svg+xml");
}

function save(text, name, type) {
  const link = element("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function legendSymbol(chart, style) {
  const mark = chart.bars || chart.areas ? Plot.barX([1], { x: () => 1, fill: style.colour })
    : Plot.dot([0], { x: () => 0.5, y: () => 0.5, symbol: style.symbol, stroke: style.colour, strokeWidth: 1.75, r: 4 });
  const svg = Plot.plot({ width: 14, height: 14, margin: 1, axis: null, x: { domain: [0, 1] },
    ...(chart.bars || chart.areas ? {} : { y: { domain: [0, 1] } }), symbol: { type: "identity" }, marks: [mark] });
  svg.setAttribute("aria-hidden", "true");
  return svg;
}

function figure(section) {
  const chart = section.chart, series = seriesOf(section), parts = [];
  if (!series.some((s) => s.good.length)) return [problem("There is nothing to draw: no result has a value here.")];
  const bad = series.flatMap((s) => s.bad.map((p) => p.label || `${s.name}: ${shown(p.x)}, ${shown(p.y)}`));
  if (bad.length) {
    const some = bad.slice(0, 8).join("; ") + (bad.length > 8 ? `; and ${bad.length - 8} more` : "");
    parts.push(problem(`Not drawn, because a value is missing or not finite (an equal picture has no PSNR): ${some}.`));
  }
  const holder = element("figure", { role: "img", "aria-label": section.sentence });
  let drawnWidth = 0;
  const redraw = (width) => {
    drawnWidth = width;
    holder.replaceChildren(draw(chart, series.filter((s) => s.on && s.good.length), width));
  };
  if (series.length > 1) {
    parts.push(element("div", { class: "legend" }, ...series.map((s) => {
      const button = element("button", { type: "button", "aria-pressed": "true", onclick: () => {
        s.on = !s.on;
        button.setAttribute("aria-pressed", String(s.on));
        redraw(drawnWidth);
      } }, legendSymbol(chart, s.style), s.name);
      return button;
    })));
  }
  parts.push(holder);
  parts.push(element("div", { class: "tools" }, element("button", { type: "button",
    onclick: () => saveSvg(holder.querySelector("svg"), section.id) }, "Save as SVG")));
  if (section.numbers) parts.push(element("details", {}, element("summary", {}, "The numbers"),
    table(section.numbers.columns, section.numbers.rows)));
  new ResizeObserver(([entry]) => {
    const width = Math.floor(entry.contentRect.width);
    if (width > 0 && width !== drawnWidth) redraw(width);
  }).observe(holder);
  return parts;
}

const image = ({ caption, width, height, png }) =>
  element("img", { src: `data:image/png;base64,${png}`, width, height, alt: caption });

const picture = (figure) =>
  element("figure", { class: "picture" }, image(figure), element("figcaption", {}, figure.caption));

// Two overlaid pictures: one left of the slider, the other right of it. A click on a small picture below
// shows it on the right.
function comparison(figures) {
  const sides = [image(figures[0]), image(figures[figures.length - 1])];
  sides[1].className = "over";
  const show = (side, k) => {
    sides[side].src = image(figures[k]).src;
    sides[side].alt = figures[k].caption;
    choices[side].value = String(k);
    thumbnails.forEach((thumbnail, i) => thumbnail.setAttribute("aria-current", String(i === Number(choices[1].value))));
  };
  const choices = ["left", "right"].map((name, side) => element("select", { "aria-label": `${name} picture`,
    onchange: (event) => show(side, Number(event.target.value)) },
    ...figures.map((figure, k) => element("option", { value: String(k) }, figure.caption))));
  const slider = element("input", { type: "range", min: "0", max: "100", value: "50", step: "0.1",
    "aria-label": "border between both pictures", oninput: () => place() });
  const over = element("div", { class: "compared" }, ...sides, slider);
  const place = () => over.style.setProperty("--border", `${slider.value}%`);
  const thumbnails = figures.map((figure, k) => element("button", { type: "button", class: "thumbnail",
    onclick: () => show(1, k) }, image(figure), figure.caption));
  show(0, 0);
  show(1, figures.length - 1);
  place();
  return element("div", {}, element("div", { class: "choices" }, ...choices), over,
    element("div", { class: "thumbnails" }, ...thumbnails));
}

function sectionParts(section) {
  if (section.problem) return [problem(section.problem)];
  const parts = section.chart ? figure(section) : [];
  if (section.table) {
    parts.push(section.table.rows.length ? table(section.table.columns, section.table.rows)
      : problem("This table is empty: nothing was measured."));
  }
  if (section.compared && section.figures.length > 1) parts.push(comparison(section.figures));
  else if (section.figures.length)
    parts.push(element("div", { class: "pictures" }, ...section.figures.map(picture)));
  return parts;
}

function show(page) {
  const main = document.querySelector("main");
  main.append(element("h1", {}, page.title), element("p", {}, page.sentence));
  main.append(element("dl", {}, ...page.facts.flatMap(([name, value]) =>
    [element("dt", {}, name), element("dd", {}, shown(value))])));
  main.append(element("div", { class: "tools" }, element("button", { type: "button",
    onclick: () => save(JSON.stringify(page.data, null, 2), "results.json", "application/json") },
    "Save the data as JSON")));
  if (!page.sections.length) main.append(problem("There are no results."));
  for (const section of page.sections) {
    const holder = element("section", { id: section.id }, element("h2", {}, section.title),
      section.sentence ? element("p", {}, section.sentence) : "");
    main.append(holder);
    try {
      holder.append(...sectionParts(section));
    } catch (error) {
      holder.append(problem(`This part could not be drawn: ${error.message}`));
    }
  }
}

try {
  show(JSON.parse(document.getElementById("page").textContent));
} catch (error) {
  document.querySelector("main").append(problem(`The results in this page are broken: ${error.message}`));
}
