// ---- the sections of the page, each a function that returns a <section>, or null if the study has no such data
function section(id, title, ...children) {
    return el('section', {id, 'aria-labelledby': id + '-title'}, el('h2', {id: id + '-title'}, title), ...children);
}
const chartBox = (id, attributes) => el('div', {id, class: 'chart', ...attributes});
const remarks = (list, kind) =>
    list.length ? el('ul', {class: kind || ''}, list.map(t => el('li', {}, shown(t)))) : null;

function shapeLink(i, size) {
    return el(
        'button',
        {type: 'button', class: 'shape', 'data-shape': i, click: () => pickShape(i), title: 'Choose for the pair'},
        size ? thumbnail(i, size, true) : null, el('span', {}, breakable(nameOf(i))));
}

/// First click: one shape is waiting; second click on another one: the pair is chosen.
let waiting = null;
function pickShape(i) {
    if (waiting === null || waiting === i) {
        waiting = i;
        announce(`${nameOf(i)} chosen. Choose the second shape.`);
        document.getElementById('pick').textContent = `${nameOf(i)} chosen – now choose the second shape.`;
        pair.listeners.forEach(f => f(i, null));
        return;
    }
    const first = waiting;
    waiting = null;
    document.getElementById('pick').textContent = '';
    choosePair(first, i);
    bringPair();
}
/// On narrow screens the panel of the pair is not beside the charts: go there.
function bringPair() {
    if (matchMedia('(max-width: 1099px)').matches) document.getElementById('pair').scrollIntoView({block: 'start'});
}

/// How many shapes the measures of the classes are about, and which they leave out, in words: nothing right can be found
/// for the only member of a class.
function measuredShapes() {
    const members = new Map();
    data.shapes.forEach(s => members.set(s.label, (members.get(s.label) || 0) + 1));
    const unlabelled = members.get('') || 0;
    members.delete('');
    const alone = [...members.values()].filter(n => n === 1).length;
    return {
        counted: data.shapes.length - unlabelled - alone,
        left: [
            alone ? plural(alone, 'is', 'are') + ' alone in ' + (alone === 1 ? 'its class' : 'their classes') : '',
            unlabelled ? plural(unlabelled, 'has', 'have') + ' no class' : ''
        ].filter(t => t).join(', ')
    };
}

function summarySection() {
    const tiles = [
        [data.shapes.length, data.dimension === 3 ? 'surfaces' : 'shapes'],
        [`${data.pairs_done} / ${data.pairs_total}`, 'pairs with a distance'], [duration(data.seconds), 'wall clock'],
        [duration(data.cpu_seconds), 'sum over the pairs'],
        [data.given_matrix ? '–' : data.failures.length, data.failures.length === 1 ? 'failure' : 'failures']
    ].filter(t => t[0] !== '–');
    const best = data.classes.find(c => known(c.nearest_neighbour));
    if (best) {
        const {counted, left} = measuredShapes();
        tiles.push([
            percent(best.nearest_neighbour),
            'nearest neighbour of the same class' + (left ? `, of ${plural(counted, 'shape')}; ${left}` : '')
        ]);
    }
    const facts = [
        [data.given_matrix ? 'table' : 'collection', data.collection], ['preset', data.preset], ['created', data.created],
        ['unit of the distances', data.distance_unit]
    ].filter(f => f[1]);
    return section(
        'summary', 'Summary',
        el('ul', {class: 'tiles'}, tiles.map(([v, what]) => el('li', {}, el('strong', {}, v), el('span', {}, what)))),
        data.warnings.map(w => el('p', {class: 'notice'}, shown(w))),
        el('dl', {class: 'facts'}, facts.map(([k, v]) => el('div', {}, el('dt', {}, k), el('dd', {}, shown(v))))),
        data.failures.length ?
            table(
                `What failed (${data.failures.length})`, ['shape or pair', 'reason and what to do'],
                data.failures.map(f => [shown(f.a) + (f.b ? ' – ' + shown(f.b) : ''), shown(f.reason)])) :
            null);
}

function matrixSection() {
    if (count < 2) return null;
    const orders = data.linkages.map((t, k) => [`tree${k}`, `${t.method} linkage, leaf order`]);
    if (labels.length) orders.push(['label', 'class']);
    data.clusterings.forEach((c, k) => orders.push([`cluster${k}`, `clusters, ${shown(c.method)}`]));
    orders.push(['name', 'name']);
    const box = chartBox(
        'matrix-chart',
        {tabindex: '0', role: 'group', 'aria-label': 'Distance matrix. Arrow keys move, Enter chooses the pair.'});
    const chooser =
        el('select', {id: 'matrix-order', change: drawMatrix}, orders.map(([v, t]) => el('option', {value: v}, t)));
    const colours =
        el('select', {
            id: 'colours',
            change: () => {
                grouping = groupings[Number(colours.value)];
                strips.textContent = grouping.title;
                drawAll();
            }
        },
           groupings.map((g, k) => el('option', {value: k}, g.title)));
    const strips = el('span', {}, grouping.title), tip = el('div', {id: 'tip', class: 'tip', hidden: true});
    function orderNow() {
        const all = [...Array(count).keys()], by = f => all.sort((i, j) => {
            const x = f(i), y = f(j);
            return x < y ? -1 : x > y ? 1 : nameOf(i) < nameOf(j) ? -1 : 1;
        });
        const value = chooser.value;
        if (value.startsWith('tree')) {
            const tree = data.linkages[Number(value.slice(4))];
            return [tree.leaf_order, tree.merges.length ? tree : null];
        }
        if (value === 'label') return [by(i => data.shapes[i].label || '\uffff'), null];
        if (value.startsWith('cluster')) {
            const {assignment} = data.clusterings[Number(value.slice(7))];
            return [by(i => assignment[i]), null];
        }
        return [by(nameOf), null];
    }
    let cursor = null, order = [], view = null;
    function tell(r, c, event) {
        const i = order[r], j = order[c];
        tip.replaceChildren(
            el('div', {class: 'tip-pictures'}, thumbnail(i, 72, true), thumbnail(j, 72, true)),
            el('div', {}, nameOf(i)), i === j ? '' : el('div', {}, nameOf(j)),
            el('strong', {}, i === j ? 'the shape itself' : withError(i, j)));
        tip.hidden = false;
        const where = box.getBoundingClientRect();
        tip.style.left = Math.min(event.clientX - where.left + 16, Math.max(0, where.width - 190)) + 'px';
        tip.style.top = event.clientY - where.top + 16 + 'px';
    }
    async function drawMatrix() {
        let tree;
        [order, tree] = orderNow();
        view = await draw(
            box, heatMapSpec(order, tree, box.clientWidth || 600, count <= 14),
            `Heat map of the ${count} by ${count} distances in the order: ${chooser.selectedOptions[0].textContent}. ` +
                'The distances are in the tables of neighbours and in distances.csv.');
        box.append(tip);
        let mouse = {clientX: 0, clientY: 0};
        box.onmousemove = e => {
            mouse = e;
        };
        box.onmouseleave = () => {
            tip.hidden = true;
        };
        view.addSignalListener('hover', (_, h) => {
            if (h)
                setTimeout(() => tell(h.y, h.x, mouse));
            else
                tip.hidden = true;
        });
        view.addSignalListener('choice', (_, h) => {
            if (h && h.x !== h.y) {
                waiting = null;
                choosePair(order[h.y], order[h.x]);
                bringPair();
            }
        });
        mark(pair.a, pair.b);
    }
    function mark(a, b) {
        if (!view || b === null) return;
        cursor = {x: order.indexOf(b), y: order.indexOf(a)};
        view.signal('chosen', cursor).runAsync();
    }
    box.addEventListener('keydown', e => {
        const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[e.key];
        if (step && cursor) {
            e.preventDefault();
            const to = v => Math.max(0, Math.min(count - 1, v));
            cursor = {x: to(cursor.x + step[0]), y: to(cursor.y + step[1])};
            view.signal('chosen', cursor).runAsync();
            announce(`${nameOf(order[cursor.y])} and ${nameOf(order[cursor.x])}: ${
                cursor.x === cursor.y ? 'the shape itself' : withError(order[cursor.y], order[cursor.x])}`);
        } else if (e.key === 'Enter' && cursor && cursor.x !== cursor.y)
            choosePair(order[cursor.y], order[cursor.x]);
    });
    pair.listeners.push(mark);
    redraws.push(drawMatrix);
    const coph = data.linkages.filter(t => known(t.cophenetic_correlation))
                     .map(t => `${t.method} ${num(t.cophenetic_correlation)}`);
    return section(
        'matrix', 'Distance matrix', el('div', {class: 'fields'}, el('label', {class: 'field'}, 'Order', chooser),
           groupings.length > 1 ? el('label', {class: 'field'}, 'Colours', colours) : null),
        box,
        el('p', {class: 'hint'},
           'Dark is near. Grey cells have no trustworthy distance. The strips along the sides show: ', strips, '.' +
               (coph.length ? ` Cophenetic correlation: ${coph.join(', ')}.` : '') +
               (data.pictures_at_one_scale || !hasPictures ? '' :
                                                             ' The small pictures are not at one scale: each shape fills its own.')),
        data.clusterings.map((_, k) => clusterTable(k)));
}

/// The members of one clustering; how stable clusters are is known of the first one only.
function clusterTable(which) {
    const c = data.clusterings[which], of = c.assignment, numbers = [...new Set(of)].sort((x, y) => x - y);
    const stability = new Map(which ? [] : data.trust.stability.map(s => [s.cluster, s.jaccard]));
    return el(
        'details', {open: count <= 60 && which === 0, class: 'clusters'},
        el('summary', {}, `${plural(numbers.length, 'cluster')}: ${shown(c.method)}, ${shown(c.cut)}`),
        table(
            `Clusters by ${shown(c.method)}` + (known(c.silhouette) ? `, mean silhouette ${num(c.silhouette)}` : '') +
                (which && known(c.agreement) ?
                     `, adjusted Rand index with ${shown(data.clusterings[0].method)} ${num(c.agreement)}` :
                     ''),
            ['#cluster', '#size', ...(stability.size ? ['#stability'] : []), 'stands for it', 'members'],
            numbers.map(k => {
                const members = [...Array(count).keys()].filter(i => of[i] === k);
                return [
                    k + 1, members.length, ...(stability.size ? [num(stability.get(k))] : []),
                    c.medoids.length ? shapeLink(c.medoids[k], 40) : '–',
                    members.slice(0, 12).map(i => nameOf(i)).join(', ') +
                        (members.length > 12 ? ` and ${members.length - 12} more` : '')
                ];
            }),
            {class: 'stack'}));
}

/// Further shapes with a place in a map.
const placedIn = map => data.placed.map((q, i) => ({i, at: q.positions[map]})).filter(q => q.at.length);

function placedTable() {
    if (!data.placed.length) return null;
    const stress = q => q.stress.length ? num(q.stress[0]) : '–';
    return table(
        'Placed by their distances (diamonds in the map), not part of the study',
        ['shape', '#distance to the nearest', '#misfit in the first map', 'its class', 'nearest'],
        data.placed.map(q => {
            const none = q.nearest === null;
            return [
                breakable(shown(q.name)), num(q.distance, 4), stress(q), none ? '–' : shown(data.shapes[q.nearest].label),
                none ? '–' : shapeLink(q.nearest, 40)
            ];
        }),
        {class: 'stack'});
}

function embeddingSection() {
    if (!data.embeddings.length) return null;
    const box = chartBox('embedding-chart'),
          chooser =
              el('select', {id: 'embedding-which', change: redraw},
                 data.embeddings.map((e, k) => el('option', {value: k}, `${e.dimension}D, ${e.method}`)));
    const graphs = [['none', 'no edges', []]];
    if (data.spanning_tree.length) graphs.push(['tree', 'minimum spanning tree', data.spanning_tree]);
    if (data.neighbour_graph.length)
        graphs.push(['near', `${data.graph_neighbours} nearest neighbours`, data.neighbour_graph]);
    const edges =
        el('select', {id: 'embedding-edges', change: redraw},
           graphs.map(([v, t], k) => el('option', {value: v, selected: k === 1 && count <= 150}, t)));
    const pictures = el('input', {type: 'checkbox', id: 'embedding-pictures', checked: hasPictures && count <= 300, change: redraw});
    let sized = false;
    const size = el('input', {
        type: 'range',
        min: 10,
        max: 72,
        value: 0,
        'aria-label': 'Size of the pictures',
        input: () => {
            sized = true;
            if (box.chart) box.chart.signal('picture', Number(size.value)).runAsync();
        }
    });
    const turn = axis => el('input', {
        type: 'range',
        min: -3.1,
        max: 3.1,
        step: 0.05,
        value: axis === 'yaw' ? 0.6 : 0.7,
        'aria-label': axis === 'yaw' ? 'Turn left and right' : 'Turn up and down',
        input: e => {
            if (box.chart) box.chart.signal(axis, Number(e.target.value) / (axis === 'yaw' ? 1 : 2)).runAsync();
        }
    });
    const turns = el('span', {class: 'field'}, 'Turn', turn('yaw'), turn('pitch')), facts = el('p', {class: 'hint'});
    async function redraw() {
        const e = data.embeddings[Number(chooser.value)];
        turns.hidden = e.dimension !== 3;
        if (!sized) {  // as large as the room allows, until the reader decides
            size.value = Math.round(Math.max(12, Math.min(44, 0.32 * (box.clientWidth || 600) / Math.sqrt(count))));
        }
        const about = `${e.method} in ${e.dimension} dimensions` + (known(e.stress) ? `, stress ${num(e.stress)}` : '') +
            '.' + (e.dimension === 3 ? ' Drag to turn.' : '') +
            (data.pictures_at_one_scale || !hasPictures ? '' : ' Each shape fills its picture, whatever its size.');
        facts.textContent = about;
        const view = await draw(
            box,
            embeddingSpec(
                e, graphs.find(g => g[0] === edges.value)[2], Math.min(900, (box.clientWidth || 600) - 76),
                {pictures: pictures.checked, picture: Number(size.value), labels: false, queries: placedIn(chooser.value)}),
            `Map of the ${count} shapes in ${
                e.dimension} dimensions; near in the picture means near in shape space. The nearest neighbours are in the table below.`);
        view.addSignalListener('pick', (_, p) => {
            if (p) pickShape(p.i);
        });
        view.addSignalListener('over', (_, i) => {
            facts.textContent =
                i === null ? about : `${nameOf(i)}${data.shapes[i].label ? ', class ' + shown(data.shapes[i].label) : ''}`;
        });
        view.signal('first', pair.a).signal('second', pair.b).runAsync();
    }
    pair.listeners.push((a, b) => {
        if (box.chart) box.chart.signal('first', a).signal('second', b).runAsync();
    });
    redraws.push(redraw);
    return section(
        'embedding', 'Map of the shapes',
        el('div', {class: 'fields'}, el('label', {class: 'field'}, 'View', chooser),
           el('label', {class: 'field'}, 'Edges', edges),
           hasPictures ? [el('label', {class: 'field'}, pictures, 'Pictures'), el('label', {class: 'field'}, 'Size', size)] :
                         null,
           turns),
        box, facts, el('p', {id: 'pick', class: 'pick'}), placedTable());
}

/// Small studies: the shapes as a labelled graph and a matrix with pictures and numbers, like Fig. 9 of the paper.
function glanceSection() {
    const flat = data.embeddings.find(e => e.dimension === 2);
    if (count < 3 || count > 12 || !flat) return null;
    const graph = chartBox('glance-graph'), matrix = chartBox('glance-matrix');
    const order = data.linkages.length ? data.linkages[0].leaf_order : [...Array(count).keys()];
    redraws.push(async () => {
        const view = await draw(
            graph,
            embeddingSpec(
                flat, fewEdges(), Math.min(620, (graph.clientWidth || 400) - 16),
                {pictures: hasPictures, picture: !hasPictures ? 10 : graph.clientWidth < 420 ? 40 : 60, labels: true}),
            'Graph of the shapes; each edge carries the distance of its ends. All distances are in the matrix beside it.');
        view.addSignalListener('pick', (_, p) => {
            if (p) pickShape(p.i);
        });
        await draw(
            matrix, heatMapSpec(order, null, matrix.clientWidth || 400, true),
            'Matrix of all distances with pictures and numbers.');
        matrix.chart.addSignalListener('choice', (_, h) => {
            if (h && h.x !== h.y) {
                choosePair(order[h.y], order[h.x]);
                bringPair();
            }
        });
    });
    return section(
        'glance', 'All shapes at a glance', el('div', {class: 'glance'}, graph, matrix),
        el('details', {}, el('summary', {}, 'All distances with their error bars'),
           table(
               'All distances, with error bars', ['shape'].concat(order.map(i => '#' + shortName(i))),
               order.map(i => [nameOf(i)].concat(order.map(j => i === j ? '0' : withError(i, j)))))));
}

/// One of the nearest shapes of i, to choose the pair.
function neighbourButton(i, j) {
    const [own, other] = [i, j].map(s => data.shapes[s].label), differ = byClass && own && other && own !== other;
    return el('button', {
        type: 'button',
        click: () => {
            choosePair(i, j);
            bringPair();
        },
        class: 'near' + (differ ? ' other' : ''),
        title: `${nameOf(j)}: ${withError(i, j)}`,
        'aria-label': `${nameOf(j)}, distance ${withError(i, j)}`
    },
              hasPictures ? thumbnail(j, 44, true) : el('strong', {}, breakable(shown(shortName(j)))),
              el('span', {}, num(distance(i, j))));
}

function neighbourSection() {
    if (count < 2) return null;
    const shownRows = el('div'),
          filter =
              el('input',
                 {type: 'search', id: 'neighbour-filter', placeholder: 'name or class', input: () => fill(false)});
    const k = Math.min(6, count - 1);
    function fill(all) {
        const wanted = filter.value.toLowerCase();
        const found = [...Array(count).keys()].filter(
            i => (nameOf(i) + ' ' + data.shapes[i].label).toLowerCase().includes(wanted));
        const rows = all ? found : found.slice(0, 24);
        shownRows.replaceChildren(
            table(
                `The ${k} nearest neighbours` +
                    (rows.length < found.length ? ` (${rows.length} of ${found.length} shapes)` : ''),
                ['shape', 'class', ...Array.from({length: k}, (_, r) => '#' + (r + 1) + '.')],
                rows.map(i => {
                    const near = neighboursOf(i);
                    return [
                        shapeLink(i, 44), shown(data.shapes[i].label),
                        ...Array.from({length: k}, (_, r) => r < near.length ? neighbourButton(i, near[r]) : '–')
                    ];
                }),
                {class: 'neighbours'}),
            rows.length < found.length ?
                el('button', {type: 'button', class: 'quiet', click: () => fill(true)}, `Show all ${found.length}`) :
                '');
    }
    fill(false);
    return section(
        'neighbours', 'Nearest neighbours',
        el('div', {class: 'fields'}, el('label', {class: 'field'}, 'Filter', filter)),
        byClass ? el('p', {class: 'hint'}, 'A dashed frame marks a neighbour of another class.') : null, shownRows);
}
