// ---- charts: specifications for Vega. Colours are the page's CSS variables, so theme and print need no new drawing.
const vega = {
    view: vegaModules['vega-view'].View,
    parse: vegaModules['vega-parser'].parse,
    interpreter: vegaModules['vega-interpreter'].expressionInterpreter,
    scheme: vegaModules['vega-scale'].scheme,
};
Object.assign(
    vegaModules['vega-dataflow'].transforms, vegaModules['vega-transforms'], vegaModules['vega-view-transforms'],
    vegaModules['vega-encode']);

/// Vega measures text on a canvas, which knows no "inherit": the family of report.css by name.
const family = getComputedStyle(document.body).fontFamily;
const chartConfig = {
    background: null,
    font: family,
    text: {font: family},
    axis: {
        domainColor: 'var(--line)',
        tickColor: 'var(--line)',
        gridColor: 'var(--grid)',
        labelColor: 'var(--ink)',
        titleColor: 'var(--ink)',
        labelFontSize: 11,
        titleFontSize: 12,
        titleFontWeight: 500,
        labelFont: family,
        titleFont: family
    },
    legend: {
        labelColor: 'var(--ink)',
        titleColor: 'var(--ink)',
        labelFontSize: 11,
        titleFontSize: 12,
        titleFontWeight: 500,
        labelFont: family,
        titleFont: family
    },
    title: {color: 'var(--ink)', fontSize: 13, fontWeight: 600, font: family},
};
const accent = 'var(--accent)';

/// Draws a specification into a container; a later call replaces the chart. Expressions are interpreted, never compiled
/// to code: the page's policy forbids that.
async function draw(container, spec, description) {
    if (container.chart) container.chart.finalize();
    container.replaceChildren();
    const view = new vega.view(
        vega.parse(Object.assign({padding: 4, description}, spec), chartConfig, {ast: true}),
        {expr: vega.interpreter, renderer: 'svg', container, hover: false, logLevel: 1});
    container.chart = view;
    await view.runAsync();
    const svg = container.querySelector('svg');
    if (svg) {
        svg.setAttribute('role', 'img');
        svg.setAttribute('aria-label', description);
    }
    return view;
}

const groupScale = () => ({
    name: 'group',
    type: 'ordinal',
    domain: grouping.names,
    range: {scheme: grouping.names.length > 10 ? 'tableau20' : 'tableau10'}
});
const groupLegend = title => ({
    fill: 'group',
    title,
    orient: 'bottom',
    columns: 6,
    symbolType: 'circle',
    labelLimit: 110,
    encode: {symbols: {update: {stroke: {value: null}}}}
});
const pictureUrl = i => data.shapes[i].picture ? data.shapes[i].picture.uri : null;
const largest = values => values.reduce((m, v) => known(v) && v > m ? v : m, 0);
/// A filled rectangle at fixed pixels.
const fixedRect = (x, y, width, height, fill) => ({
    type: 'rect',
    aria: false,
    encode: {
        update: {
            x: {value: x},
            y: {value: y},
            width: {value: width},
            height: {value: height},
            fill: {value: fill}
        }
    }
});
/// Axes below and on the left of a plot of two quantities, and the place of a point in it.
const plotAxes = (xTitle, yTitle) => [
    {orient: 'bottom', scale: 'x', title: xTitle, grid: true, tickCount: 5},
    {orient: 'left', scale: 'y', title: yTitle, grid: true, tickCount: 5}
];
const atPoint = {
    x: {scale: 'x', field: 'x'},
    y: {scale: 'y', field: 'y'}
};
