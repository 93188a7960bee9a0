// ---- the map of the shapes, in the plane and in space
/// Moves the shapes of a small graph apart until their pictures no longer overlap; the map is only a hint there.
function pushApart(points, least) {
    for (let sweep = 0, moved = true; moved && sweep < 300; ++sweep) {
        moved = false;
        points.forEach((p, i) => points.slice(i + 1).forEach((q, k) => {
            let dx = q.x - p.x, dy = q.y - p.y;
            const r = Math.hypot(dx, dy);
            if (r >= least) return;
            if (r < 1e-9 * least) {
                dx = Math.cos(k);
                dy = Math.sin(k);
            }
            const push = 0.26 * (least - r) / Math.max(Math.hypot(dx, dy), 1e-12);
            p.x -= push * dx;
            p.y -= push * dy;
            q.x += push * dx;
            q.y += push * dy;
            moved = true;
        }));
    }
}

/// Edges of a graph small enough for numbers: the spanning tree, and every shape with its two nearest.
function fewEdges() {
    const chosen = new Map(), add = (a, b, length) => chosen.set(Math.min(a, b) + ' ' + Math.max(a, b), {a, b, length});
    data.spanning_tree.forEach(e => add(e.a, e.b, e.length));
    data.shapes.forEach((_, i) => neighboursOf(i).slice(0, 2).forEach(j => add(i, j, distance(i, j))));
    return [...chosen.values()];
}

/// Where on its edge each number stands: as near to the middle as other numbers, pictures and names allow.
function labelPlaces(edges, points, perUnit, picture) {
    const at = new Map(points.map(p => [p.i, [p.x * perUnit, -p.y * perUnit]])), places = [];
    const near = (d, reach) => Math.max(0, 1 - Math.abs(d) / reach);
    return edges.map(e => {
        const [ax, ay] = at.get(e.a), [bx, by] = at.get(e.b);
        let best = 0.5, least = Infinity;
        for (const t of [0.5, 0.43, 0.57, 0.36, 0.64, 0.3, 0.7]) {
            const x = ax + t * (bx - ax), y = ay + t * (by - ay);
            let harm = Math.abs(t - 0.5);
            for (const [qx, qy] of places) harm += 10 * near(x - qx, 46) * near(y - qy, 16);
            for (const [qx, qy] of at.values())
                harm += 10 * near(Math.hypot(x - qx, y - qy), 0.62 * picture + 14) +
                    10 * near(x - qx, 56) * near(y - qy - 0.62 * picture - 12, 16);
            if (harm < least) {
                least = harm;
                best = t;
            }
        }
        places.push([ax + best * (bx - ax), ay + best * (by - ay)]);
        return best;
    });
}

/// Diamonds with names: shapes that are not part of the study, at their places.
function queryMarks(named) {
    const at = {x: {scale: 'x', field: 'px'}, y: {scale: 'y', field: 'py'}};
    const name = kind => ({
        type: 'text',
        from: {data: 'queries'},
        interactive: false,
        aria: false,
        encode: {
            update: {
                ...at,
                dy: {value: -16},
                text: {field: 'name'},
                limit: {value: 140},
                align: {value: 'center'},
                fontSize: {value: 11},
                fontWeight: {value: 600},
                fill: {value: kind === 'halo' ? null : 'var(--ink)'},
                stroke: {value: kind === 'halo' ? 'var(--paper)' : null},
                strokeWidth: {value: 4}
            }
        }
    });
    const diamond = {
        name: 'query',
        type: 'symbol',
        from: {data: 'queries'},
        aria: false,
        encode: {
            update: {
                ...at,
                shape: {value: 'diamond'},
                size: {value: 190},
                fill: {value: 'var(--accent)'},
                stroke: {value: 'var(--paper)'},
                strokeWidth: {value: 1.5},
                tooltip: {field: 'name'}
            }
        }
    };
    return named ? [diamond, name('halo'), name('text')] : [diamond];
}

/// Shapes at their places in the plane, or in space seen from an angle, with the edges of a graph.
/// options.queries: numbers in data.placed and places in this map, {i, at}
function embeddingSpec(embedding, edges, size, options) {
    const d = embedding.dimension, at = (i, a) => a < d ? embedding.coordinates[i * d + a] : 0;
    const shapes = [];
    for (let i = 0; i < count; ++i) {
        if (known(at(i, 0)))
            shapes.push(
                {i, x: at(i, 0), y: at(i, 1), z: at(i, 2), url: pictureUrl(i), group: groupOf(i), name: shortName(i)});
    }
    const centre = a => {
        const v = shapes.map(p => p['xyz'[a]]);
        return d === 3 ? v.reduce((s, x) => s + x, 0) / (v.length || 1) :
            v.length   ? (Math.min(...v) + Math.max(...v)) / 2 :
                         0;
    };
    const c = [0, 1, 2].map(centre);
    const queries = (options.queries || [])
                        .map(q => ({x: q.at[0], y: q.at[1], z: d === 3 ? q.at[2] : 0, name: shown(data.placed[q.i].name)}));
    const points = shapes.concat(queries);
    points.forEach(p => {
        p.x -= c[0];
        p.y -= c[1];
        p.z -= c[2];
    });
    let reach = [0, 0];
    points.forEach(p => {
        reach = d === 3 ? reach.map(r => Math.max(r, Math.hypot(p.x, p.y, p.z))) :
                          [Math.max(reach[0], Math.abs(p.x)), Math.max(reach[1], Math.abs(p.y))];
    });
    const picture = options.picture, margin = picture / 2 + 14, width = size;
    let perUnit = (width - 2 * margin) / (2 * reach[0] || 1);
    for (let round = 0; options.labels && round < 4; ++round) {  // pushing needs room, making room moves closer
        pushApart(shapes, 1.9 * Math.max(picture, 44) / perUnit);  // dots have names below them, too
        shapes.forEach(p => {
            reach = [Math.max(reach[0], Math.abs(p.x)), Math.max(reach[1], Math.abs(p.y))];
        });
        perUnit = (width - 2 * margin) / (2 * reach[0] || 1);
    }
    const height = d === 3 ? Math.min(size, 560) : Math.max(220, Math.min(620, 2 * reach[1] * perUnit + 2 * margin));
    const scale = Math.min(perUnit, (height - 2 * margin) / (2 * reach[1] || 1)),
          range = p => [-p / (2 * scale || 1), p / (2 * scale || 1)];
    const inGraph = new Set(shapes.map(p => p.i)), drawn = edges.filter(e => inGraph.has(e.a) && inGraph.has(e.b));
    const along = options.labels ? labelPlaces(drawn, shapes, scale, picture) : [];
    const turn = axis => ({
        name: axis,
        value: d === 3 ? (axis === 'yaw' ? 0.6 : 0.35) : 0,
        on: d === 3 ? [{
            events: '[@back:mousedown, window:mouseup] > window:mousemove!',
            update: axis === 'yaw' ? 'yawStart + (x() - grab.x) * 0.01' :
                                     'clamp(pitchStart + (y() - grab.y) * 0.01, -1.57, 1.57)'
        }] :
                      []
    });
    const seen = [
        {type: 'formula', as: 'px', expr: 'datum.x * cos(yaw) + datum.z * sin(yaw)'},
        {type: 'formula', as: 'pz', expr: 'datum.z * cos(yaw) - datum.x * sin(yaw)'},
        {type: 'formula', as: 'py', expr: 'datum.y * cos(pitch) - datum.pz * sin(pitch)'},
        {type: 'formula', as: 'depth', expr: 'datum.y * sin(pitch) + datum.pz * cos(pitch)'}
    ];
    const begin = axis => ({name: axis + 'Start', value: 0, on: [{events: '@back:mousedown', update: axis}]});
    const chosen = 'datum.i === first || datum.i === second || datum.i === over';
    const rim = [{test: chosen, value: accent}, {scale: 'group', field: 'group'}];
    // A picture and its disc are one group, so that near shapes hide far ones as a whole.
    const disc = {
        name: 'shape',
        type: 'group',
        from: {data: 'shapes'},
        aria: false,
        sort: {field: 'datum.depth'},
        encode: {
            update: {
                x: {signal: 'scale(\'x\', datum.px) - 0.62 * picture'},
                y: {signal: 'scale(\'y\', datum.py) - 0.62 * picture'},
                width: {signal: '1.24 * picture'},
                height: {signal: '1.24 * picture'},
                cornerRadius: {signal: '0.62 * picture'},
                cursor: {value: 'pointer'},
                fill: {value: 'var(--plate)'},
                fillOpacity: {value: 0.9},
                stroke: rim,
                strokeWidth: {signal: `${chosen} ? 3.5 : 1.6`}
            }
        },
        marks: [{
            type: 'image',
            interactive: false,
            aria: false,
            encode: {
                update: {
                    url: {field: {parent: 'url'}},
                    aspect: {value: true},
                    x: {signal: '0.12 * picture'},
                    y: {signal: '0.12 * picture'},
                    width: {signal: 'picture'},
                    height: {signal: 'picture'}
                }
            }
        }]
    };
    const dot = {
        name: 'shape',
        type: 'symbol',
        from: {data: 'shapes'},
        aria: false,
        sort: {field: 'datum.depth'},
        encode: {
            update: {
                x: {scale: 'x', field: 'px'},
                y: {scale: 'y', field: 'py'},
                shape: {value: 'circle'},
                cursor: {value: 'pointer'},
                size: {value: 90},
                fill: {scale: 'group', field: 'group'},
                fillOpacity: {value: 0.9},
                stroke: rim,
                strokeWidth: {signal: `${chosen} ? 3.5 : 0`}
            }
        }
    };
    return {
        width,
        height,
        autosize: 'pad',
        signals: [
            {name: 'grab', value: {x: 0, y: 0}, on: [{events: '@back:mousedown', update: '{x: x(), y: y()}'}]},
            begin('yaw'), begin('pitch'), turn('yaw'), turn('pitch'), {
                name: 'over',
                value: null,
                on: [{events: '@shape:mouseover', update: 'datum.i'}, {events: '@shape:mouseout', update: 'null'}]
            },
            {name: 'pick', value: null, on: [{events: '@shape:click', update: '{i: datum.i, at: now()}'}]},
            {name: 'first', value: null}, {name: 'second', value: null}, {name: 'picture', value: picture}
        ],
        data: [
            {name: 'shapes', values: shapes, transform: seen}, {name: 'queries', values: queries, transform: seen}, {
                name: 'edges',
                values: drawn.map((e, k) => ({a: e.a, b: e.b, text: num(e.length), t: along[k]})),
                transform: [{type: 'lookup', from: 'shapes', key: 'i', fields: ['a', 'b'], as: ['A', 'B']}]
            }
        ],
        scales: [
            groupScale(), {name: 'x', domain: range(width), range: [0, width], zero: false, nice: false},
            {name: 'y', domain: range(height), range: [height, 0], zero: false, nice: false}
        ],
        axes: d === 3 || options.labels ?
            [] :
            [
                {orient: 'bottom', scale: 'x', tickCount: 6, grid: true, title: 'unit of the distances'},
                {orient: 'left', scale: 'y', tickCount: 5, grid: true}
            ],
        legends: grouping.names.length > 1 && grouping.names.length <= 36 ? [groupLegend(grouping.title)] : [],
        marks:
            [
                {
                    name: 'back',
                    type: 'rect',
                    aria: false,
                    encode: {
                        update: {
                            width: {value: width},
                            height: {value: height},
                            fill: {value: 'transparent'},
                            stroke: {value: 'var(--grid)'},
                            cursor: {value: d === 3 ? 'grab' : 'default'}
                        }
                    }
                },
                {
                    type: 'rule',
                    from: {data: 'edges'},
                    interactive: false,
                    aria: false,
                    encode: {
                        update: {
                            x: {scale: 'x', field: 'A.px'},
                            y: {scale: 'y', field: 'A.py'},
                            x2: {scale: 'x', field: 'B.px'},
                            y2: {scale: 'y', field: 'B.py'},
                            stroke: {value: 'var(--edge)'},
                            strokeWidth: {value: options.labels ? 1.6 : 1.1}
                        }
                    }
                },
                options.pictures ? disc : dot
            ]
                .concat(
                    queries.length ? queryMarks(queries.length <= 40) : [],
                    options.labels ?
                        [].concat(
                            ['halo', 'text'].map(
                                kind => ({
                                    type: 'text',
                                    from: {data: 'edges'},
                                    interactive: false,
                                    aria: false,
                                    encode: {
                                        update: {
                                            x: {signal: '(1 - datum.t) * scale(\'x\', datum.A.px) + datum.t * scale(\'x\', datum.B.px)'},
                                            y: {signal: '(1 - datum.t) * scale(\'y\', datum.A.py) + datum.t * scale(\'y\', datum.B.py)'},
                                            text: {field: 'text'},
                                            align: {value: 'center'},
                                            baseline: {value: 'middle'},
                                            fontSize: {value: 12},
                                            fontWeight: {value: 600},
                                            fill: {value: kind === 'halo' ? null : 'var(--ink)'},
                                            stroke: {value: kind === 'halo' ? 'var(--paper)' : null},
                                            strokeWidth: {value: 4}
                                        }
                                    }
                                })),
                            {
                                type: 'text',
                                from: {data: 'shapes'},
                                interactive: false,
                                aria: false,
                                encode: {
                                    update: {
                                        x: {scale: 'x', field: 'px'},
                                        y: {scale: 'y', field: 'py'},
                                        dy: {signal: 'picture * 0.62 + 12'},
                                        text: {field: 'name'},
                                        limit: {value: 120},
                                        align: {value: 'center'},
                                        fontSize: {value: 11},
                                        fill: {value: 'var(--ink)'}
                                    }
                                }
                            }) :
                        []),
    };
}
