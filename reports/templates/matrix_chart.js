// ---- heat map and dendrogram
/// Merges of a tree as three segments each, and the range of leaves each merge covers.
function treeSegments(tree) {
    const place = [], low = [], high = [], height = [];
    tree.leaf_order.forEach((leaf, k) => {
        place[leaf] = low[leaf] = high[leaf] = k;
        height[leaf] = 0;
    });
    const segments = [];
    tree.merges.forEach(([p, q, h], row) => {
        const c = count + row;
        place[c] = (place[p] + place[q]) / 2;
        low[c] = Math.min(low[p], low[q]);
        high[c] = Math.max(high[p], high[q]);
        height[c] = h;
        const common = {low: low[c], high: high[c], h};
        segments.push(
            {x: place[p], x2: place[p], y: height[p], y2: h, ...common},
            {x: place[q], x2: place[q], y: height[q], y2: h, ...common},
            {x: place[p], x2: place[q], y: h, y2: h, ...common});
    });
    return segments;
}

function treeGroup(y, height, cell, unit) {
    return {
        type: 'group',
        encode: {update: {y: {value: y}, width: {signal: 'width'}, height: {value: height}}},
        scales: [
            {name: 'leaf', domain: [-0.5, count - 0.5], range: [0, cell * count], zero: false},
            {name: 'height', domain: {data: 'tree', field: 'y2'}, range: [height, 0], zero: true, nice: true}
        ],
        axes: [{orient: 'left', scale: 'height', tickCount: 3, title: unit, offset: 4}],
        marks: ['shown', 'grip'].map(
            kind => ({
                name: kind === 'grip' ? 'branch' : null,
                type: 'rule',
                from: {data: 'tree'},
                encode: {
                    update: {
                        x: {scale: 'leaf', field: 'x'},
                        x2: {scale: 'leaf', field: 'x2'},
                        y: {scale: 'height', field: 'y'},
                        y2: {scale: 'height', field: 'y2'},
                        stroke: kind === 'grip' ? {value: 'transparent'} : {
                            signal:
                                'branch && datum.low >= branch.low && datum.high <= branch.high ? \'var(--accent)\' : \'var(--ink)\''
                        },
                        strokeWidth:
                            {value: kind === 'grip' ? 9 :
                                 count > 150        ? 0.7 :
                                                      1.3},
                        strokeCap: {value: 'round'}
                    }
                }
            }))
    };
}

/// The matrix as an image of one pixel per cell, in the colours of Vega's scheme; empty pixels for missing distances.
function matrixImage(order, top) {
    const canvas = document.createElement('canvas'), n = order.length;
    canvas.width = canvas.height = n;
    const context = canvas.getContext('2d'), image = context.createImageData(n, n), colour = vega.scheme('viridis');
    const ramp = Array.from({length: 256}, (_, k) => colour(k / 255).match(/[0-9a-f]{2}/gi));
    const bytes = Array.from({length: 256}, (_, k) => {
        const c = colour(k / 255);
        return c[0] === '#' ? ramp[k].map(h => parseInt(h, 16)) : c.match(/\d+/g).map(Number);
    });
    for (let r = 0; r < n; ++r)
        for (let c = 0; c < n; ++c) {
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
        side = hasPictures && cell >= 12 ? Math.min(cell, 64) : 0;
    }
    const size = cell * count, gap = side + band + 5, top = largest(data.distances);
    const cells = [];
    if (numbers && cell >= 30)
        order.forEach((i, r) => order.forEach((j, c) => {
            const d = distance(i, j);
            cells.push({r, c, d, text: known(d) ? num(d) : ''});
        }));
    const letters = Math.max(1, ...cells.map(c => c.text.length));
    const plates = fixedRect(-band - 3 - side, -band - 3 - side, size + side + band + 3, side, 'var(--plate)');
    const plateColumn = fixedRect(-band - 3 - side, 0, side, size, 'var(--plate)');
    const pictures = vertical => ({
        type: 'image',
        from: {data: 'leaves'},
        aria: false,
        encode: {
            update: {
                url: {field: 'url'},
                aspect: {value: true},
                align: {value: 'center'},
                baseline: {value: 'middle'},
                width: {value: Math.max(0, side - 3)},
                height: {value: Math.max(0, side - 3)},
                x: vertical ? {value: -band - 4 - side / 2} : {signal: `(datum.k + 0.5) * ${cell}`},
                y: vertical ? {signal: `(datum.k + 0.5) * ${cell}`} : {value: -band - 4 - side / 2}
            }
        }
    });
    const bands = vertical => ({
        type: 'rect',
        from: {data: 'leaves'},
        aria: false,
        encode: {
            update: {
                fill: {scale: 'group', field: 'group'},
                x: vertical ? {value: -band - 2} : {signal: `datum.k * ${cell}`},
                width: {value: vertical ? band : cell},
                y: vertical ? {signal: `datum.k * ${cell}`} : {value: -band - 2},
                height: {value: vertical ? cell : band}
            }
        }
    });
    const frame = (test, value, colour) => ({
        type: 'rect',
        interactive: false,
        encode: {
            update: {
                x: {signal: `${test} ? ${value}.x * ${cell} : 0`},
                y: {signal: `${test} ? ${value}.y * ${cell} : 0`},
                width: {signal: `${test} ? (${value}.w || 1) * ${cell} : 0`},
                height: {signal: `${test} ? (${value}.h || 1) * ${cell} : 0`},
                stroke: {value: colour},
                strokeWidth: {value: 2},
                opacity: {signal: `${test} ? 1 : 0`}
            }
        }
    });
    const at = `{x: clamp(floor(x() / ${cell}), 0, ${count - 1}), y: clamp(floor(y() / ${cell}), 0, ${count - 1})}`;
    return {
        width: size,
        height: size,
        autosize: 'pad',
        signals: [
            {
                name: 'hover',
                value: null,
                on: [{events: '@field:mousemove', update: at}, {events: '@field:mouseout', update: 'null'}]
            },
            {name: 'choice', value: null, on: [{events: '@field:click', update: at}]},
            {name: 'chosen', value: null},
            {
                name: 'branch',
                value: null,
                on: tree ?
                    [
                        {
                            events: '@branch:mouseover',
                            update:
                                '{low: datum.low, high: datum.high, x: datum.low, y: datum.low, w: datum.high - datum.low + 1, h: datum.high - datum.low + 1}'
                        },
                        {events: '@branch:mouseout', update: 'null'}
                    ] :
                    []
            },
            {name: 'names', value: order.map(shortName)},
        ],
        data: [
            {name: 'leaves', values: order.map((i, k) => ({k, i, url: pictureUrl(i), group: groupOf(i)}))},
            {name: 'cells', values: cells}
        ].concat(tree ? [{name: 'tree', values: treeSegments(tree)}] : []),
        scales: [
            groupScale(), {name: 'colour', type: 'linear', domain: [0, top || 1], range: {scheme: 'viridis'}},
            {name: 'row', type: 'band', domain: order.map((_, k) => k), range: [0, size]}
        ],
        axes: named ? [{
            orient: 'left',
            scale: 'row',
            domain: false,
            ticks: false,
            offset: gap,
            labelLimit: 105,
            labelPadding: 3,
            encode: {labels: {update: {text: {signal: 'names[datum.value]'}}}}
        }] :
                      [],
        legends: [{
            fill: 'colour',
            orient: 'bottom',
            direction: 'horizontal',
            title: data.given_matrix ? 'distance' : 'distance (path length)',
            gradientLength: Math.min(240, size),
            gradientThickness: 10
        }],
        marks: [].concat(
            tree ? [treeGroup(-gap - 96, 92, cell, 'height')] : [], bands(true), bands(false),
            side ? [plates, plateColumn, pictures(true), pictures(false)] : [],
            fixedRect(0, 0, size, size, 'var(--missing)'), {
                type: 'image',
                aria: false,
                encode: {
                    update: {
                        url: {value: matrixImage(order, top)},
                        width: {value: size},
                        height: {value: size},
                        aspect: {value: false},
                        smooth: {value: false}
                    }
                }
            },
            cells.length ? [{
                type: 'text',
                from: {data: 'cells'},
                interactive: false,
                aria: false,
                encode: {
                    update: {
                        x: {signal: `(datum.c + 0.5) * ${cell}`},
                        y: {signal: `(datum.r + 0.5) * ${cell}`},
                        align: {value: 'center'},
                        baseline: {value: 'middle'},
                        fontSize: {value: Math.min(14, cell / 3.4, cell / (0.58 * letters))},
                        text: {field: 'text'},
                        fill: {signal: `datum.d > ${0.6 * top} ? '#111' : '#fff'`}
                    }
                }
            }] :
                           [],
            frame('branch', 'branch', 'var(--accent)'), frame('hover', 'hover', '#fff'),
            frame('chosen', 'chosen', 'var(--accent)'), {
                name: 'field',
                type: 'rect',
                aria: false,
                encode: {
                    enter: {fill: {value: 'transparent'}, cursor: {value: 'pointer'}},
                    update: {width: {value: size}, height: {value: size}}
                }
            }),
    };
}

/// A tree on its own, pictures below the leaves.
function dendrogramSpec(tree, room, title) {
    const cell = Math.min(64, (room - 76) / count), side = cell >= 12 ? cell : 0;
    return {
        width: cell * count,
        height: 150 + side,
        autosize: 'pad',
        title: {text: title, anchor: 'start'},
        signals: [{name: 'branch', value: null}],
        data: [
            {name: 'tree', values: treeSegments(tree)},
            {name: 'leaves', values: tree.leaf_order.map((i, k) => ({k, url: pictureUrl(i), group: groupOf(i)}))}
        ],
        scales: [groupScale()],
        marks: [
            treeGroup(0, 146, cell, 'height'), {
                type: 'rect',
                from: {data: 'leaves'},
                aria: false,
                encode: {
                    update: {
                        x: {signal: `datum.k * ${cell} + 1`},
                        width: {value: Math.max(1, cell - 2)},
                        y: {value: 149},
                        height: {value: 5},
                        fill: {scale: 'group', field: 'group'}
                    }
                }
            }
        ]
                   .concat(
                       side ?
                           [
                               fixedRect(0, 155, cell * count, side + 2, 'var(--plate)'),
                               {
                                   type: 'image',
                                   from: {data: 'leaves'},
                                   aria: false,
                                   encode: {
                                       update: {
                                           url: {field: 'url'},
                                           aspect: {value: true},
                                           x: {signal: `datum.k * ${cell} + 1`},
                                           y: {value: 157},
                                           width: {value: side - 2},
                                           height: {value: side - 2}
                                       }
                                   }
                               }
                           ] :
                           [])
    };
}
