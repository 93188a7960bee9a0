// ---- scatter plots, curves, bars
/// Points of two quantities against each other, with the line on which they would agree.
function scatterSpec(points, size, xTitle, yTitle, line) {
    const top = Math.max(largest(points.map(p => p.x)), largest(points.map(p => p.y)));
    return {
        width: size,
        height: Math.min(size, 320),
        autosize: 'pad',
        data: [{name: 'points', values: points}, {name: 'line', values: line || [{x: 0, y: 0}, {x: top, y: top}]}],
        scales: [
            {name: 'x', domain: {data: 'points', field: 'x'}, range: 'width', nice: true, zero: true},
            {name: 'y', domain: {data: 'points', field: 'y'}, range: 'height', nice: true, zero: true}
        ],
        axes: plotAxes(xTitle, yTitle),
        marks: [
            {
                type: 'symbol',
                from: {data: 'points'},
                aria: false,
                clip: true,
                encode: {
                    update: {
                        ...atPoint,
                        size: {value: points.length > 400 ? 9 : 24},
                        fill: {value: accent},
                        fillOpacity: {value: points.length > 400 ? 0.35 : 0.7}
                    }
                }
            },
            {
                type: 'line',
                from: {data: 'line'},
                aria: false,
                clip: true,
                encode: {
                    update: {
                        ...atPoint,
                        stroke: {value: 'var(--ink)'},
                        strokeDash: {value: [5, 4]},
                        strokeWidth: {value: 1.2}
                    }
                }
            }
        ]
    };
}

function curveSpec(curves, size, xTitle, yTitle) {
    return {
        width: size,
        height: Math.min(size, 280),
        autosize: 'pad',
        data: [{name: 'points', values: curves}],
        scales: [
            {name: 'x', domain: [0, 1], range: 'width'}, {name: 'y', domain: [0, 1], range: 'height'},
            {name: 'which', type: 'ordinal', domain: {data: 'points', field: 'name'}, range: {scheme: 'tableau10'}}
        ],
        axes: plotAxes(xTitle, yTitle),
        legends: new Set(curves.map(c => c.name)).size > 1 ?
            [{stroke: 'which', orient: 'bottom', columns: 2, symbolType: 'stroke'}] :
            [],
        marks: [{
            type: 'group',
            from: {facet: {name: 'curve', data: 'points', groupby: 'name'}},
            marks: [{
                type: 'line',
                from: {data: 'curve'},
                aria: false,
                encode: {
                    update: {
                        ...atPoint,
                        stroke: {scale: 'which', field: 'name'},
                        strokeWidth: {value: 2}
                    }
                }
            }]
        }]
    };
}

/// Bars of one value per item; signed values go left and right of zero.
function barSpec(values, room, title, horizontal, colours, itemTitle) {
    const step =
        horizontal ? Math.max(2, Math.min(16, 520 / values.length)) : Math.min(46, (room - 84) / values.length);
    const length = horizontal ? room - (step >= 9 ? 180 : 50) : 130, span = step * values.length;
    const along = horizontal ? 'y' : 'x', across = horizontal ? 'x' : 'y';
    return {
        width: horizontal ? length : span,
        height: horizontal ? span : length,
        autosize: 'pad',
        data: [{name: 'items', values}],
        scales: [
            groupScale(), {
                name: 'item',
                type: 'band',
                domain: {data: 'items', field: 'k'},
                range: [0, span],
                padding: step > 4 ? 0.15 : 0
            },
            {
                name: 'value',
                domain: {data: 'items', field: 'value'},
                range: horizontal ? [0, length] : [length, 0],
                zero: true,
                nice: true
            }
        ],
        signals: [{name: 'names', value: values.map(v => v.name)}],
        axes: [{orient: horizontal ? 'top' : 'left', scale: 'value', title, grid: true, tickCount: 5, format: '~g'}].concat(
            step >= 9 ? [{
                orient: horizontal ? 'left' : 'bottom',
                scale: 'item',
                ticks: false,
                domain: false,
                labelLimit: 120,
                labelPadding: 4,
                labelFontSize: horizontal ? Math.min(11, step - 1) : 11,
                title: itemTitle || null,
                encode: {labels: {update: {text: {signal: 'names[datum.value]'}}}}
            }] :
                        []),
        marks: [{
            type: 'rect',
            from: {data: 'items'},
            aria: false,
            encode: {
                update: {
                    [along]: {scale: 'item', field: 'k'},
                    [horizontal ? 'height' : 'width']: {scale: 'item', band: 1},
                    [across]: {scale: 'value', value: 0},
                    [across + '2']: {scale: 'value', field: 'value'},
                    fill: colours ? {scale: 'group', field: 'group'} : {value: accent}
                }
            }
        }]
    };
}
