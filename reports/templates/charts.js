// ---- charts: specifications for Vega. Colours are the page's CSS variables, so theme and print need no new drawing.
const vega = {
  view: vegaModules["vega-view"].View, parse: vegaModules["vega-parser"].parse,
  interpreter: vegaModules["vega-interpreter"].expressionInterpreter, scheme: vegaModules["vega-scale"].scheme,
};
Object.assign(vegaModules["vega-dataflow"].transforms, vegaModules["vega-transforms"], vegaModules["vega-view-transforms"],
  vegaModules["vega-encode"]);

/// Vega measures text on a canvas, which knows no "inherit": the family of report.css by name.
const family = getComputedStyle(document.body).fontFamily;
const chartConfig = {
  background: null, font: family,
  axis: {domainColor: "var(--line)", tickColor: "var(--line)", gridColor: "var(--grid)", labelColor: "var(--ink)",
    titleColor: "var(--ink)", labelFontSize: 11, titleFontSize: 12, titleFontWeight: 500, labelFont: family, titleFont: family},
  legend: {labelColor: "var(--ink)", titleColor: "var(--ink)", labelFontSize: 11, titleFontSize: 12, titleFontWeight: 500,
    labelFont: family, titleFont: family},
  title: {color: "var(--ink)", fontSize: 13, fontWeight: 600, font: family},
};
const accent = "var(--accent)";

/// Draws a specification into a container; a later call replaces the chart. Expressions are interpreted, never compiled
/// to code: the page's policy forbids that.
async function draw(container, spec, description) {
  if (container.chart) container.chart.finalize();
  container.replaceChildren();
  const view = new vega.view(vega.parse(Object.assign({padding: 4, description}, spec), chartConfig, {ast: true}),
    {expr: vega.interpreter, renderer: "svg", container, hover: false, logLevel: 1});
  container.chart = view;
  await view.runAsync();
  const svg = container.querySelector("svg");
  if (svg) { svg.setAttribute("role", "img"); svg.setAttribute("aria-label", description); }
  return view;
}

const groupScale = {name: "group", type: "ordinal", domain: groupNames, range: {scheme: groupNames.length > 10 ? "tableau20" : "tableau10"}};
const groupLegend = title => ({fill: "group", title, orient: "bottom", columns: 6, symbolType: "circle", labelLimit: 110,
  encode: {symbols: {update: {stroke: {value: null}}}}});
const pictureUrl = i => data.shapes[i].picture ? data.shapes[i].picture.uri : null;
const largest = values => values.reduce((m, v) => known(v) && v > m ? v : m, 0);

/// Merges of a tree as three segments each, and the range of leaves each merge covers.
function treeSegments(tree) {
  const place = [], low = [], high = [], height = [];
  tree.leaf_order.forEach((leaf, k) => { place[leaf] = low[leaf] = high[leaf] = k; height[leaf] = 0; });
  const segments = [];
  tree.merges.forEach(([p, q, h], row) => {
    const c = count + row;
    place[c] = (place[p] + place[q]) / 2; low[c] = Math.min(low[p], low[q]); high[c] = Math.max(high[p], high[q]); height[c] = h;
    const common = {low: low[c], high: high[c], h};
    segments.push({x: place[p], x2: place[p], y: height[p], y2: h, ...common}, {x: place[q], x2: place[q], y: height[q], y2: h, ...common},
      {x: place[p], x2: place[q], y: h, y2: h, ...common});
  });
  return segments;
}

function treeGroup(y, height, cell, unit) {
  return {type: "group", encode: {update: {y: {value: y}, width: {signal: "width"}, height: {value: height}}},
    scales: [{name: "leaf", domain: [-0.5, count - 0.5], range: [0, cell * count], zero: false},
      {name: "height", domain: {data: "tree", field: "y2"}, range: [height, 0], zero: true, nice: true}],
    axes: [{orient: "left", scale: "height", tickCount: 3, title: unit, offset: 4}],
    marks: ["shown", "grip"].map(kind => ({name: kind === "grip" ? "branch" : null, type: "rule", from: {data: "tree"}, encode: {update: {
      x: {scale: "leaf", field: "x"}, x2: {scale: "leaf", field: "x2"}, y: {scale: "height", field: "y"}, y2: {scale: "height", field: "y2"},
      stroke: kind === "grip" ? {value: "transparent"} : {signal: "branch && datum.low >= branch.low && datum.high <= branch.high ? 'var(--accent)' : 'var(--ink)'"},
      strokeWidth: {value: kind === "grip" ? 9 : count > 150 ? 0.7 : 1.3}, strokeCap: {value: "round"}}}}))};
}

/// The matrix as an image of one pixel per cell, in the colours of Vega's scheme; empty pixels for missing distances.
function matrixImage(order, top) {
  const canvas = document.createElement("canvas"), n = order.length;
  canvas.width = canvas.height = n;
  const context = canvas.getContext("2d"), image = context.createImageData(n, n), colour = vega.scheme("viridis");
  const ramp = Array.from({length: 256}, (_, k) => colour(k / 255).match(/[0-9a-f]{2}/gi));
  const bytes = Array.from({length: 256}, (_, k) => {
    const c = colour(k / 255);
    return c[0] === "#" ? ramp[k].map(h => parseInt(h, 16)) : c.match(/\d+/g).map(Number);
  });
  for (let r = 0; r < n; ++r) for (let c = 0; c < n; ++c) {
    const d = distance(order[r], order[c]);
    if (!known(d)) continue;
    const rgb = bytes[Math.round(255 * Math.min(1, d / (top || 1)))];
    image.data.set([rgb[0], rgb[1], rgb[2], 255], 4 * (r * n + c));
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

/// Heat map with pictures along the sides and, if the order is that of a tree, its dendrogram.
function heatMapSpec(order, tree, room, numbers) {
  const named = room > 560 && count <= 60, band = 5;
  let side = 0, cell = 0;
  for (let k = 0; k < 3; ++k) {  // pictures as wide as a cell; their column takes room from the cells
    const left = Math.max(tree ? 62 : 0, side + band + 5 + (named ? 118 : 0));
    cell = Math.min(72, (room - left - 20) / count);
    side = cell >= 12 ? Math.min(cell, 64) : 0;
  }
  const size = cell * count, gap = side + band + 5, top = largest(data.distances);
  const cells = [];
  if (numbers && cell >= 30) order.forEach((i, r) => order.forEach((j, c) => cells.push({r, c, d: distance(i, j)})));
  const plates = {type: "rect", aria: false, encode: {update: {x: {value: -band - 3 - side}, y: {value: -band - 3 - side},
    width: {value: size + side + band + 3}, height: {value: side}, fill: {value: "var(--plate)"}}}};
  const plateColumn = {type: "rect", aria: false, encode: {update: {x: {value: -band - 3 - side}, y: {value: 0}, width: {value: side},
    height: {value: size}, fill: {value: "var(--plate)"}}}};
  const pictures = vertical => ({type: "image", from: {data: "leaves"}, aria: false, encode: {update: {
    url: {field: "url"}, aspect: {value: true}, align: {value: "center"}, baseline: {value: "middle"},
    width: {value: Math.max(0, side - 3)}, height: {value: Math.max(0, side - 3)},
    x: vertical ? {value: -band - 4 - side / 2} : {signal: `(datum.k + 0.5) * ${cell}`},
    y: vertical ? {signal: `(datum.k + 0.5) * ${cell}`} : {value: -band - 4 - side / 2}}}});
  const bands = vertical => ({type: "rect", from: {data: "leaves"}, aria: false, encode: {update: {
    fill: {scale: "group", field: "group"},
    x: vertical ? {value: -band - 2} : {signal: `datum.k * ${cell}`}, width: {value: vertical ? band : cell},
    y: vertical ? {signal: `datum.k * ${cell}`} : {value: -band - 2}, height: {value: vertical ? cell : band}}}});
  const frame = (test, value, colour) => ({type: "rect", interactive: false, encode: {update: {
    x: {signal: `${test} ? ${value}.x * ${cell} : 0`}, y: {signal: `${test} ? ${value}.y * ${cell} : 0`},
    width: {signal: `${test} ? (${value}.w || 1) * ${cell} : 0`}, height: {signal: `${test} ? (${value}.h || 1) * ${cell} : 0`},
    stroke: {value: colour}, strokeWidth: {value: 2}, opacity: {signal: `${test} ? 1 : 0`}}}});
  const at = `{x: clamp(floor(x() / ${cell}), 0, ${count - 1}), y: clamp(floor(y() / ${cell}), 0, ${count - 1})}`;
  return {
    width: size, height: size, autosize: "pad",
    signals: [
      {name: "hover", value: null, on: [{events: "@field:mousemove", update: at}, {events: "@field:mouseout", update: "null"}]},
      {name: "choice", value: null, on: [{events: "@field:click", update: at}]},
      {name: "chosen", value: null},
      {name: "branch", value: null, on: tree ? [{events: "@branch:mouseover", update: "{low: datum.low, high: datum.high, x: datum.low, y: datum.low, w: datum.high - datum.low + 1, h: datum.high - datum.low + 1}"},
        {events: "@branch:mouseout", update: "null"}] : []},
      {name: "names", value: order.map(shortName)},
    ],
    data: [{name: "leaves", values: order.map((i, k) => ({k, i, url: pictureUrl(i), group: groupOf(i)}))},
      {name: "cells", values: cells}].concat(tree ? [{name: "tree", values: treeSegments(tree)}] : []),
    scales: [groupScale, {name: "colour", type: "linear", domain: [0, top || 1], range: {scheme: "viridis"}},
      {name: "row", type: "band", domain: order.map((_, k) => k), range: [0, size]}],
    axes: named ? [{orient: "left", scale: "row", domain: false, ticks: false, offset: gap, labelLimit: 105, labelPadding: 3,
      encode: {labels: {update: {text: {signal: "names[datum.value]"}}}}}] : [],
    legends: [{fill: "colour", orient: "bottom", direction: "horizontal", title: "distance (path length)",
      gradientLength: Math.min(240, size), gradientThickness: 10}],
    marks: [].concat(tree ? [treeGroup(-gap - 96, 92, cell, "height")] : [],
      bands(true), bands(false), side ? [plates, plateColumn, pictures(true), pictures(false)] : [],
      {type: "rect", aria: false, encode: {update: {width: {value: size}, height: {value: size}, fill: {value: "var(--missing)"}}}},
      {type: "image", aria: false, encode: {update: {url: {value: matrixImage(order, top)}, width: {value: size}, height: {value: size},
        aspect: {value: false}, smooth: {value: false}}}},
      cells.length ? [{type: "text", from: {data: "cells"}, interactive: false, aria: false, encode: {update: {
        x: {signal: `(datum.c + 0.5) * ${cell}`}, y: {signal: `(datum.r + 0.5) * ${cell}`}, align: {value: "center"}, baseline: {value: "middle"},
        fontSize: {value: Math.min(14, cell / 3.4)}, text: {signal: "datum.d === null ? '' : datum.d === 0 ? '0' : format(datum.d, '.3f')"},
        fill: {signal: `datum.d > ${0.6 * top} ? '#111' : '#fff'`}}}}] : [],
      frame("branch", "branch", "var(--accent)"), frame("hover", "hover", "#fff"), frame("chosen", "chosen", "var(--accent)"),
      {name: "field", type: "rect", aria: false, encode: {enter: {fill: {value: "transparent"}, cursor: {value: "pointer"}},
        update: {width: {value: size}, height: {value: size}}}}),
  };
}

/// Moves the shapes of a small graph apart until their pictures no longer overlap; the map is only a hint there.
function pushApart(points, least) {
  for (let sweep = 0, moved = true; moved && sweep < 300; ++sweep) {
    moved = false;
    points.forEach((p, i) => points.slice(i + 1).forEach((q, k) => {
      let dx = q.x - p.x, dy = q.y - p.y;
      const r = Math.hypot(dx, dy);
      if (r >= least) return;
      if (r < 1e-9 * least) { dx = Math.cos(k); dy = Math.sin(k); }
      const push = 0.26 * (least - r) / Math.max(Math.hypot(dx, dy), 1e-12);
      p.x -= push * dx; p.y -= push * dy; q.x += push * dx; q.y += push * dy;
      moved = true;
    }));
  }
}

/// Shapes at their places in the plane, or in space seen from an angle, with the edges of a graph.
function embeddingSpec(embedding, edges, size, options) {
  const d = embedding.dimension, at = (i, a) => a < d ? embedding.coordinates[i * d + a] : 0;
  const shapes = [];
  for (let i = 0; i < count; ++i) {
    if (known(at(i, 0))) shapes.push({i, x: at(i, 0), y: at(i, 1), z: at(i, 2), url: pictureUrl(i), group: groupOf(i), name: shortName(i)});
  }
  const centre = a => { const v = shapes.map(p => p["xyz"[a]]); return d === 3 ? v.reduce((s, x) => s + x, 0) / (v.length || 1) : v.length ? (Math.min(...v) + Math.max(...v)) / 2 : 0; };
  const c = [0, 1, 2].map(centre);
  shapes.forEach(p => { p.x -= c[0]; p.y -= c[1]; p.z -= c[2]; });
  let reach = [0, 0];
  shapes.forEach(p => {
    reach = d === 3 ? reach.map(r => Math.max(r, Math.hypot(p.x, p.y, p.z))) : [Math.max(reach[0], Math.abs(p.x)), Math.max(reach[1], Math.abs(p.y))];
  });
  const picture = options.picture, margin = picture / 2 + 14, width = size;
  let perUnit = (width - 2 * margin) / (2 * reach[0] || 1);
  for (let round = 0; options.labels && round < 4; ++round) {  // pushing needs room, making room moves closer
    pushApart(shapes, 1.9 * picture / perUnit);
    shapes.forEach(p => { reach = [Math.max(reach[0], Math.abs(p.x)), Math.max(reach[1], Math.abs(p.y))]; });
    perUnit = (width - 2 * margin) / (2 * reach[0] || 1);
  }
  const height = d === 3 ? Math.min(size, 560) : Math.max(220, Math.min(620, 2 * reach[1] * perUnit + 2 * margin));
  const scale = Math.min(perUnit, (height - 2 * margin) / (2 * reach[1] || 1)), range = p => [-p / (2 * scale || 1), p / (2 * scale || 1)];
  const inGraph = new Set(shapes.map(p => p.i));
  const turn = axis => ({name: axis, value: d === 3 ? (axis === "yaw" ? 0.6 : 0.35) : 0, on: d === 3 ? [{events: "[@back:mousedown, window:mouseup] > window:mousemove!",
    update: axis === "yaw" ? "yawStart + (x() - grab.x) * 0.01" : "clamp(pitchStart + (y() - grab.y) * 0.01, -1.57, 1.57)"}] : []});
  const begin = axis => ({name: axis + "Start", value: 0, on: [{events: "@back:mousedown", update: axis}]});
  const chosen = "datum.i === first || datum.i === second || datum.i === over";
  const rim = [{test: chosen, value: accent}, {scale: "group", field: "group"}];
  // A picture and its disc are one group, so that near shapes hide far ones as a whole.
  const disc = {name: "shape", type: "group", from: {data: "shapes"}, aria: false, sort: {field: "datum.depth"}, encode: {update: {
    x: {signal: "scale('x', datum.px) - 0.62 * picture"}, y: {signal: "scale('y', datum.py) - 0.62 * picture"}, width: {signal: "1.24 * picture"},
    height: {signal: "1.24 * picture"}, cornerRadius: {signal: "0.62 * picture"}, cursor: {value: "pointer"}, fill: {value: "var(--plate)"},
    fillOpacity: {value: 0.9}, stroke: rim, strokeWidth: {signal: `${chosen} ? 3.5 : 1.6`}}},
    marks: [{type: "image", interactive: false, aria: false, encode: {update: {url: {field: {parent: "url"}}, aspect: {value: true},
      x: {signal: "0.12 * picture"}, y: {signal: "0.12 * picture"}, width: {signal: "picture"}, height: {signal: "picture"}}}}]};
  const dot = {name: "shape", type: "symbol", from: {data: "shapes"}, aria: false, sort: {field: "datum.depth"}, encode: {update: {
    x: {scale: "x", field: "px"}, y: {scale: "y", field: "py"}, shape: {value: "circle"}, cursor: {value: "pointer"}, size: {value: 90},
    fill: {scale: "group", field: "group"}, fillOpacity: {value: 0.9}, stroke: rim, strokeWidth: {signal: `${chosen} ? 3.5 : 0`}}}};
  return {
    width, height, autosize: "pad",
    signals: [{name: "grab", value: {x: 0, y: 0}, on: [{events: "@back:mousedown", update: "{x: x(), y: y()}"}]},
      begin("yaw"), begin("pitch"), turn("yaw"), turn("pitch"),
      {name: "over", value: null, on: [{events: "@shape:mouseover", update: "datum.i"}, {events: "@shape:mouseout", update: "null"}]},
      {name: "pick", value: null, on: [{events: "@shape:click", update: "{i: datum.i, at: now()}"}]},
      {name: "first", value: null}, {name: "second", value: null}, {name: "picture", value: picture}],
    data: [{name: "shapes", values: shapes, transform: [
        {type: "formula", as: "px", expr: "datum.x * cos(yaw) + datum.z * sin(yaw)"},
        {type: "formula", as: "pz", expr: "datum.z * cos(yaw) - datum.x * sin(yaw)"},
        {type: "formula", as: "py", expr: "datum.y * cos(pitch) - datum.pz * sin(pitch)"},
        {type: "formula", as: "depth", expr: "datum.y * sin(pitch) + datum.pz * cos(pitch)"}]},
      {name: "edges", values: edges.filter(e => inGraph.has(e.a) && inGraph.has(e.b)).map(e => ({a: e.a, b: e.b, length: e.length})), transform: [
        {type: "lookup", from: "shapes", key: "i", fields: ["a", "b"], as: ["A", "B"]}]}],
    scales: [groupScale, {name: "x", domain: range(width), range: [0, width], zero: false, nice: false},
      {name: "y", domain: range(height), range: [height, 0], zero: false, nice: false}],
    axes: d === 3 || options.labels ? [] : [{orient: "bottom", scale: "x", tickCount: 6, grid: true, title: "unit of the distances"},
      {orient: "left", scale: "y", tickCount: 5, grid: true}],
    legends: groupNames.length > 1 && groupNames.length <= 36 ? [groupLegend(byClass ? "class" : "cluster")] : [],
    marks: [{name: "back", type: "rect", aria: false, encode: {update: {width: {value: width}, height: {value: height}, fill: {value: "transparent"},
        stroke: {value: "var(--grid)"}, cursor: {value: d === 3 ? "grab" : "default"}}}},
      {type: "rule", from: {data: "edges"}, interactive: false, aria: false, encode: {update: {
        x: {scale: "x", field: "A.px"}, y: {scale: "y", field: "A.py"}, x2: {scale: "x", field: "B.px"}, y2: {scale: "y", field: "B.py"},
        stroke: {value: "var(--edge)"}, strokeWidth: {value: options.labels ? 1.6 : 1.1}}}},
      options.pictures ? disc : dot].concat(
      options.labels ? [].concat(["halo", "text"].map(kind => ({type: "text", from: {data: "edges"}, interactive: false, aria: false, encode: {update: {
        x: {signal: "(scale('x', datum.A.px) + scale('x', datum.B.px)) / 2"}, y: {signal: "(scale('y', datum.A.py) + scale('y', datum.B.py)) / 2"},
        text: {signal: "format(datum.length, datum.length < 0.1 ? '.4f' : '.3f')"}, align: {value: "center"}, baseline: {value: "middle"}, fontSize: {value: 12}, fontWeight: {value: 600},
        fill: {value: kind === "halo" ? null : "var(--ink)"}, stroke: {value: kind === "halo" ? "var(--paper)" : null}, strokeWidth: {value: 4}}}})),
      {type: "text", from: {data: "shapes"}, interactive: false, aria: false, encode: {update: {
        x: {scale: "x", field: "px"}, y: {scale: "y", field: "py"}, dy: {signal: "picture * 0.62 + 12"}, text: {field: "name"}, limit: {value: 120},
        align: {value: "center"}, fontSize: {value: 11}, fill: {value: "var(--ink)"}}}}) : []),
  };
}

/// A tree on its own, pictures below the leaves.
function dendrogramSpec(tree, room, title) {
  const cell = Math.min(64, (room - 76) / count), side = cell >= 12 ? cell : 0;
  return {width: cell * count, height: 150 + side, autosize: "pad", title: {text: title, anchor: "start"}, signals: [{name: "branch", value: null}],
    data: [{name: "tree", values: treeSegments(tree)},
      {name: "leaves", values: tree.leaf_order.map((i, k) => ({k, url: pictureUrl(i), group: groupOf(i)}))}],
    scales: [groupScale],
    marks: [treeGroup(0, 146, cell, "height"), {type: "rect", from: {data: "leaves"}, aria: false, encode: {update: {
        x: {signal: `datum.k * ${cell} + 1`}, width: {value: Math.max(1, cell - 2)}, y: {value: 149}, height: {value: 5}, fill: {scale: "group", field: "group"}}}}]
      .concat(side ? [{type: "rect", aria: false, encode: {update: {x: {value: 0}, y: {value: 155}, width: {value: cell * count}, height: {value: side + 2}, fill: {value: "var(--plate)"}}}},
        {type: "image", from: {data: "leaves"}, aria: false, encode: {update: {url: {field: "url"}, aspect: {value: true},
        x: {signal: `datum.k * ${cell} + 1`}, y: {value: 157}, width: {value: side - 2}, height: {value: side - 2}}}}] : [])};
}

/// Points of two quantities against each other, with the line on which they would agree.
function scatterSpec(points, size, xTitle, yTitle, line) {
  const top = Math.max(largest(points.map(p => p.x)), largest(points.map(p => p.y)));
  return {width: size, height: Math.min(size, 320), autosize: "pad",
    data: [{name: "points", values: points}, {name: "line", values: line || [{x: 0, y: 0}, {x: top, y: top}]}],
    scales: [{name: "x", domain: {data: "points", field: "x"}, range: "width", nice: true, zero: true},
      {name: "y", domain: {data: "points", field: "y"}, range: "height", nice: true, zero: true}],
    axes: [{orient: "bottom", scale: "x", title: xTitle, grid: true, tickCount: 5}, {orient: "left", scale: "y", title: yTitle, grid: true, tickCount: 5}],
    marks: [{type: "symbol", from: {data: "points"}, aria: false, clip: true, encode: {update: {x: {scale: "x", field: "x"}, y: {scale: "y", field: "y"},
        size: {value: points.length > 400 ? 9 : 24}, fill: {value: accent}, fillOpacity: {value: points.length > 400 ? 0.35 : 0.7}}}},
      {type: "line", from: {data: "line"}, aria: false, clip: true, encode: {update: {x: {scale: "x", field: "x"}, y: {scale: "y", field: "y"},
        stroke: {value: "var(--ink)"}, strokeDash: {value: [5, 4]}, strokeWidth: {value: 1.2}}}}]};
}

function curveSpec(curves, size, xTitle, yTitle) {
  return {width: size, height: Math.min(size, 280), autosize: "pad", data: [{name: "points", values: curves}],
    scales: [{name: "x", domain: [0, 1], range: "width"}, {name: "y", domain: [0, 1], range: "height"},
      {name: "which", type: "ordinal", domain: {data: "points", field: "name"}, range: {scheme: "tableau10"}}],
    axes: [{orient: "bottom", scale: "x", title: xTitle, grid: true, tickCount: 5}, {orient: "left", scale: "y", title: yTitle, grid: true, tickCount: 5}],
    legends: new Set(curves.map(c => c.name)).size > 1 ? [{stroke: "which", orient: "bottom", columns: 2, symbolType: "stroke"}] : [],
    marks: [{type: "group", from: {facet: {name: "curve", data: "points", groupby: "name"}}, marks: [{type: "line", from: {data: "curve"}, aria: false,
      encode: {update: {x: {scale: "x", field: "x"}, y: {scale: "y", field: "y"}, stroke: {scale: "which", field: "name"}, strokeWidth: {value: 2}}}}]}]};
}

/// Bars of one value per item; signed values go left and right of zero.
function barSpec(values, room, title, horizontal, colours, itemTitle) {
  const step = horizontal ? Math.max(2, Math.min(16, 520 / values.length)) : Math.min(46, (room - 84) / values.length);
  const length = horizontal ? room - (step >= 9 ? 180 : 50) : 130, span = step * values.length;
  const along = horizontal ? "y" : "x", across = horizontal ? "x" : "y";
  return {width: horizontal ? length : span, height: horizontal ? span : length, autosize: "pad", data: [{name: "items", values}],
    scales: [groupScale, {name: "item", type: "band", domain: {data: "items", field: "k"}, range: [0, span], padding: step > 4 ? 0.15 : 0},
      {name: "value", domain: {data: "items", field: "value"}, range: horizontal ? [0, length] : [length, 0], zero: true, nice: true}],
    signals: [{name: "names", value: values.map(v => v.name)}],
    axes: [{orient: horizontal ? "top" : "left", scale: "value", title, grid: true, tickCount: 5}].concat(step >= 9 ? [{orient: horizontal ? "left" : "bottom",
      scale: "item", ticks: false, domain: false, labelLimit: 120, title: itemTitle || null, encode: {labels: {update: {text: {signal: "names[datum.value]"}}}}}] : []),
    marks: [{type: "rect", from: {data: "items"}, aria: false, encode: {update: {
      [along]: {scale: "item", field: "k"}, [horizontal ? "height" : "width"]: {scale: "item", band: 1},
      [across]: {scale: "value", value: 0}, [across + "2"]: {scale: "value", field: "value"},
      fill: colours ? {scale: "group", field: "group"} : {value: accent}}}}]};
}
