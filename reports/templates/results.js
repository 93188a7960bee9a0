// ---- the sections that judge: classes, trust, volumes, comparison, and how to repeat the study
function classSection() {
    if (!data.classes.length) return null;
    const ks = [...new Set(data.classes.flatMap(c => c.k_nearest.map(x => x.k)))].filter(k => k > 1).sort((x, y) => x - y);
    const find = (c, k) => {
        const hit = c.k_nearest.find(x => x.k === k);
        return hit ? percent(hit.accuracy) : '–';
    };
    const curve = chartBox('pr-chart'),
          points =
              data.classes.flatMap(c => c.precision_recall.filter(p => known(p.precision)).map(p => ({x: p.recall, y: p.precision, name: c.name})));
    if (points.length)
        redraws.push(
            () => draw(
                curve, curveSpec(points, Math.min(440, (curve.clientWidth || 400) - 76), 'recall', 'precision'),
                'Precision against recall, mean over all queries; the points are in the table below.'));
    const rows = [
        ['nearest neighbour (1-NN)', c => percent(c.nearest_neighbour)],
        ...ks.map(k => [`${k} nearest neighbours`, c => find(c, k)]),
        ['bull\'s-eye', c => percent(c.bulls_eye) + (!known(c.bulls_eye) ? '' : c.bulls_eye_window ? ` (first ${c.bulls_eye_window})` : ' (first 2 m, m the size of the class)')],
        ['mean average precision', c => num(c.mean_average_precision)],
        ['adjusted Rand index of the clusters', c => num(c.adjusted_rand)],
        ['adjusted mutual information', c => num(c.adjusted_mutual_information)],
        ['PERMANOVA F', c => num(c.permanova_f)], ['PERMANOVA R²', c => num(c.permanova_r2)],
        ['PERMANOVA p', c => known(c.permanova_p) ? `${num(c.permanova_p)} (${c.permutations} permutations)` : '–']
    ].filter(([, f]) => data.classes.some(c => f(c) !== '–'));
    const {counted, left} = measuredShapes();
    return section(
        'classes', 'Classes',
        left ? el('p', {class: 'hint'},
                  `Neighbours, bull's-eye, precision, recall and confusion are of ${plural(counted, 'shape')}: ${left}.`) :
               null,
        table(
            'How well the distances know the classes', ['measure', ...data.classes.map(c => '#' + c.name)],
            rows.map(([t, f]) => [t, ...data.classes.map(f)])),
        points.length ? curve : null,
        points.length ? el('details', {}, el('summary', {}, 'Precision and recall as a table'),
                           table(
                               'Precision and recall', ['ranking', '#recall', '#precision'],
                               points.map(p => [p.name, num(p.x), num(p.y)]))) :
                        null,
        data.classes.map(c => counted && c.confusion.length ? confusionTable(c) : null),
        data.classes[0].class_medoids.length ?
            el('div', {}, el('h3', {}, 'The shape that stands for each class'),
               el('ul', {class: 'gallery'},
                  data.classes[0].class_medoids.map(
                      (i, k) =>
                          el('li', {}, thumbnail(i, 72),
                             el('strong', {}, shown(data.classes[0].classes[k] || data.shapes[i].label)),
                             el('span', {}, breakable(nameOf(i))))))) :
            null);
}

function confusionTable(c) {
    const made = table(
        `Confusion matrix: ${shown(c.name)}`,
        ['class', ...c.classes.map(n => '#' + shown(n))], c.confusion.map((row, r) => [shown(c.classes[r]), ...row]),
        {class: 'confusion'});
    made.querySelectorAll('tbody tr').forEach((tr, r) => {
        const sum = c.confusion[r].reduce((s, v) => s + v, 0) || 1;
        tr.querySelectorAll('td').forEach((td, k) => {
            const share = c.confusion[r][k] / sum;
            td.style.setProperty('--share', share.toFixed(3));
            td.classList.add(k === r ? 'right' : share > 0 ? 'wrong' : 'none');
        });
    });
    return el(
        'details', {open: c.classes.length <= 15}, el('summary', {}, `Confusion matrix: ${shown(c.name)}`),
        el('p', {class: 'hint'}, 'Rows are the true classes, columns the class of the nearest neighbour.'), made);
}

function trustSection() {
    const t = data.trust, flat = data.embeddings[0], verdicts = [];
    if (t.triangles_checked && !t.triangles_violated)
        verdicts.push(
            t.triangles_checked === 1 ? 'The triangle inequality holds in the one triangle there is.' :
                                        `The triangle inequality holds in all ${t.triangles_checked} triangles.`);
    else if (t.triangles_checked)
        verdicts.push(
            `${t.triangles_violated} of ${plural(t.triangles_checked, 'triangle')} ${
                t.triangles_violated === 1 ? 'violates' : 'violate'} the triangle inequality` +
            (!hasErrors                     ? '.' :
                 t.triangles_beyond_error   ? `; ${t.triangles_beyond_error} of them by more than the error bars explain.` :
                 t.triangles_violated === 1 ? '; its error bars explain it.' :
                                              '; the error bars explain all of them.'));
    if (known(t.median_asymmetry))
        verdicts.push(`Forward and backward paths differ by ${percent(t.median_asymmetry)} in the median and ${
            percent(t.max_asymmetry)} at most.`);
    // Pairs of shapes that are left out are among the failures only.
    const failed = Math.max(t.not_converged.length, data.failures.filter(f => f.b).length);
    if (!data.given_matrix)
        verdicts.push(
            failed ? `${plural(failed, 'pair')} did not converge or gave no trustworthy path.` :
                     'Every computed pair converged.');
    if (t.perturbations)
        verdicts.push(`With distances moved within their error bars (${t.perturbations} runs, seed ${
            t.seed}) the clusters agree with those shown: adjusted Rand index ${num(t.stability_rand)}.`);
    if (known(t.graph_correlation) && data.graph_neighbours)
        verdicts.push(`Path lengths along the graph of the ${
            plural(data.graph_neighbours, 'nearest neighbour')} rank the pairs as the distances do: rank correlation ${
            num(t.graph_correlation)}.`);
    t.close_clusters.forEach(
        c => verdicts.push(`Clusters ${c.first + 1} and ${c.second + 1} lie ${
            num(c.gap)} apart, which is less than the error ${num(c.error)}: do not tell them apart.`));
    const shepard = chartBox('shepard-chart'),
          which = data.embeddings.length ?
        el('select', {change: drawShepard},
           data.embeddings.map((e, k) => el('option', {value: k}, `${e.dimension}D, ${e.method}`))) :
        null;
    function drawShepard() {
        const e = data.embeddings[Number(which.value)], d = e.dimension, points = [], fitted = [];
        const stride = Math.max(1, Math.floor(count * (count - 1) / 2 / 2500));
        let k = 0;
        for (let i = 0; i < count; ++i)
            for (let j = i + 1; j < count; ++j, ++k) {
                if (k % stride || !known(distance(i, j))) continue;
                let s = 0;
                for (let a = 0; a < d; ++a) s += (e.coordinates[i * d + a] - e.coordinates[j * d + a]) ** 2;
                points.push({x: distance(i, j), y: Math.sqrt(s)});
                if (e.disparities.length && known(e.disparities[k]))
                    fitted.push({x: distance(i, j), y: e.disparities[k]});
            }
        fitted.sort((p, q) => p.x - q.x);
        return draw(
            shepard,
            scatterSpec(
                points, Math.min(420, (shepard.clientWidth || 360) - 76), distanceName, 'distance in the map',
                fitted.length ? fitted : null),
            `Shepard diagram: distances in the map against the ${distanceName}s; on the dashed line the map is exact.`);
    }
    const silhouette = chartBox('silhouette-chart');
    const separated = t.silhouettes.length > 0 && new Set(clusters).size > 1;  // else every silhouette is 0
    if (separated)
        redraws.push(() => {
            const order =
                [...Array(count).keys()]
                    .filter(i => known(t.silhouettes[i]))
                    .sort(
                        (i, j) => clusters && clusters[i] !== clusters[j] ? clusters[i] - clusters[j] :
                                                                            t.silhouettes[j] - t.silhouettes[i]);
            return draw(
                silhouette,
                barSpec(
                    order.map((i, k) => ({k, value: t.silhouettes[i], name: shortName(i), group: groupOf(i)})),
                    Math.min(460, silhouette.clientWidth || 400), 'silhouette', true, true),
                'Silhouette of every shape, by cluster: near 1 it sits well, below 0 it would fit another cluster better. The numbers are in the table of shapes.');
        });
    if (flat) redraws.push(drawShepard);
    return section(
        'trust', 'How far to trust this', remarks(verdicts.concat(t.remarks), 'verdicts'),
        el('div', {class: 'two'},
           flat ? el('div', {}, el('h3', {}, 'Does the map tell the truth?'),
                     el('label', {class: 'field'}, 'Map', which), shepard) :
                  null,
           separated ? el('div', {}, el('h3', {}, 'Do the shapes sit in their clusters?'), silhouette) :
                                  null),
        t.worst_triangles.length ?
            el('details', {}, el('summary', {}, 'Worst triangles'),
               table(
                   'Triangles that violate the inequality most', ['from', 'via', 'to', '#excess', '#error'],
                   t.worst_triangles.map(
                       v => [nameOf(v.a), nameOf(v.via), nameOf(v.b), num(v.excess), num(v.error)]))) :
            null,
        t.asymmetries.length ?
            el('details', {}, el('summary', {}, 'Asymmetry'),
               table(
                   'Pairs computed both ways', ['from', 'to', '#forward', '#backward'],
                   t.asymmetries.map(v => [nameOf(v.a), nameOf(v.b), num(v.forward, 4), num(v.backward, 4)]))) :
            null,
        t.not_converged.length ?
            el('details', {open: t.not_converged.length <= 10}, el('summary', {}, 'Pairs that did not converge'),
               table(
                   'Pairs that did not converge', ['from', 'to', 'remark'],
                   t.not_converged.map(
                       p =>
                           [el('button', {type: 'button', class: 'shape', click: () => choosePair(p.a, p.b)},
                               nameOf(p.a)),
                            nameOf(p.b), shown(p.remark)]))) :
            null,
        shapeTable());
}

function shapeTable() {
    const stress = data.embeddings.length ? data.embeddings[0].stress_per_shape : [],
          silhouettes = data.trust.silhouettes;
    return el(
        'details', {}, el('summary', {}, `All ${count} shapes`),
        table(
            'All shapes',
            [
                'shape', 'class', '#cluster', data.dimension === 3 ? '#volume' : '#area', '#silhouette',
                '#share of the stress', 'notes'
            ],
            data.shapes.map(
                (s, i) =>
                    [nameOf(i), shown(s.label), clusterOf(i) || '–', num(s.volume), num(silhouettes[i], 2),
                     percent(stress[i]), s.notes.map(shown).join(' ')])));
}

/// Shapes that the two clusterings place differently, once each cluster by volume is matched with the cluster by
/// distance with which it shares most shapes.
function placedDifferently(assignment) {
    const pairs = new Map();
    data.shapes.forEach((s, i) => {
        const key = assignment[i] + ' ' + clusterOf(i);
        pairs.set(key, (pairs.get(key) || 0) + 1);
    });
    const match = new Map(), taken = new Set();
    for (const [key] of [...pairs].sort((a, b) => b[1] - a[1])) {
        const [volume, distance] = key.split(' ').map(Number);
        if (match.has(volume) || taken.has(distance)) continue;
        match.set(volume, distance);
        taken.add(distance);
    }
    return data.shapes.map((s, i) => i).filter(i => match.get(assignment[i]) !== clusterOf(i));
}

function volumeSection() {
    const v = data.volumes, word = data.dimension === 3 ? 'volume' : 'area', spread = data.volume_spread;
    if (!v) {
        if (count < 3 || !known(spread)) return null;
        const within = spread < 5e-7 ? 'to all digits shown' : `within ${num(100 * spread, 2)} %`;
        return section(
            'volumes', `More than ${word}?`,
            el('p', {},
               `All ${word}s are equal ${within}: ${word} tells nothing of these shapes, and whatever separates them ` +
                   'is in the distances.'));
    }
    const left = chartBox('by-distance'), right = chartBox('by-volume'),
          moved = clusterOf(0) ? placedDifferently(v.assignment) : [];
    redraws.push(async () => {
        if (data.linkages.length)
            await draw(
                left, dendrogramSpec(data.linkages[0], Math.min(520, left.clientWidth || 400), 'By geodesic distance'),
                'Dendrogram by geodesic distance.');
        await draw(
            right, dendrogramSpec(v.tree, Math.min(520, right.clientWidth || 400), `By ${word}`),
            `Dendrogram by difference of ${word}.`);
    });
    return section(
        'volumes', `More than ${word}?`,
        el('p', {},
           `Rank correlation between geodesic distance and difference of ${word}: ${
               num(v.rank_correlation)}; agreement of the clusters (adjusted Rand index): ${num(v.adjusted_rand)}.`),
        el('p', {},
           moved.length ? `Placed differently by distance and by ${word}: ${moved.length} of ${plural(count, 'shape')}, ${
                              moved.slice(0, 12).map(nameOf).join(', ')}${moved.length > 12 ? ', …' : ''}.` :
                          `Both put the same shapes together.`),
        el('div', {class: 'two'}, left, right),
        el('details', {open: count <= 30}, el('summary', {}, 'Clusters as a table'),
           table(
               `Clusters by distance and by ${word}`, ['shape', `#${word}`, '#by distance', `#by ${word}`],
               data.shapes.map((s, i) => [nameOf(i), num(s.volume), clusterOf(i) || '–', v.assignment[i] + 1]))));
}

function compareSection() {
    const c = data.compare;
    if (!c) return null;
    const box = chartBox('compare-chart');
    if (c.distances.length)
        redraws.push(
            () => draw(
                box,
                scatterSpec(
                    c.distances.filter(d => known(d[0]) && known(d[1])).map(d => ({x: d[0], y: d[1]})),
                    Math.min(440, (box.clientWidth || 400) - 76), 'distance here', `distance in ${shown(c.other)}`),
                'Distances of the common pairs in both studies; on the dashed line they are equal.'));
    return section(
        'compare', `Compared with ${shown(c.other)}`,
        el('p', {},
           `${c.common_shapes} shapes and ${
               c.common_pairs} pairs in common. Rank correlation of the distances: Spearman ${
               num(c.spearman)}, Kendall ${num(c.kendall)}; Pearson ${num(c.pearson)}. ` +
               (c.neighbours ? `Of the ${c.neighbours} nearest neighbours ${percent(c.mean_overlap)} are the same.` :
                               '')),
        c.distances.length ? box : null,
        c.moved.length ? table(
                             'Shapes whose nearest neighbours differ',
                             ['shape', 'nearest here', 'nearest there', '#common neighbours'],
                             c.moved.map(m => [shown(m.shape), shown(m.here), shown(m.there), percent(m.overlap)])) :
                         null,
        c.different_settings.length ?
            table(
                'Settings that differ (here | there)', ['setting', 'values', 'meaning'],
                c.different_settings.map(s => [shown(s.name), shown(s.value), shown(s.description)])) :
            null);
}

/// Only files beside the report are linked; anything with a scheme or an absolute path is shown as text.
const relative = href => !/^[a-z][a-z0-9+.-]*:/i.test(href) && !/^[\\/]/.test(href);

function repeatSection() {
    return section(
        'repeat', 'Files, settings, versions',
        data.links.length ?
            el('ul', {class: 'links'},
               data.links.map(
                   l =>
                       el('li', {},
                          relative(l.href) ? el('a', {href: l.href.split('/').map(encodeURIComponent).join('/')},
                                                shown(l.title || l.href)) :
                                             shown(l.title || l.href),
                          l.description ? ' – ' + shown(l.description) : ''))) :
            null,
        data.command ? el('div', {}, el('p', {}, 'This command computes the distances again:'),
                          el('pre', {tabindex: '0'}, el('code', {}, data.command)), copyButton(data.command)) :
                       null,
        el('div', {class: 'two'},
           data.settings.length ? table(
                                      'Settings', ['name', 'value', 'meaning'],
                                      data.settings.map(s => [shown(s.name), shown(s.value), shown(s.description)]),
                                      {class: 'stack'}) :
                                  null,
           data.versions.length ? table(
                                      'Versions', ['component', 'version', ''],
                                      data.versions.map(s => [shown(s.name), shown(s.value), shown(s.description)]),
                                      {class: 'stack'}) :
                                  null));
}
