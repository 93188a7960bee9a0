// ---- the model, and text made of it. Names are data: they reach the page as text nodes and attribute values only.
const data = JSON.parse(document.getElementById('data').textContent);
const count = data.shapes.length;
const distanceName = data.given_matrix ? 'distance' : 'geodesic distance';

/// An element; children are nodes or strings (text). Attributes: values are set as text; functions become listeners.
function el(tag, attributes, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) {
        if (value === null || value === undefined || value === false) continue;
        if (typeof value === 'function')
            node.addEventListener(key, value);
        else
            node.setAttribute(key, value === true ? '' : value);
    }
    for (const child of children.flat(3)) {
        if (child === null || child === undefined) continue;
        node.append(child instanceof Node ? child : document.createTextNode(String(child)));
    }
    return node;
}

const known = x => x !== null && x !== undefined && Number.isFinite(x);
function num(x, digits = 3) {
    if (!known(x)) return '–';
    if (x !== 0 && (Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3)) {
        const [digit, power] = x.toExponential(digits - 1).split('e');
        return `${digit}·10${[...power.replace('+', '')].map(c => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('')}`;
    }
    return Number(x.toPrecision(digits)).toString();
}
const percent = x => known(x) ? (100 * x).toFixed(1) + ' %' : '–';
function duration(s) {
    if (!known(s)) return '–';
    if (s < 1) return num(1000 * s, 2) + ' ms';
    if (s < 120) return num(s, 3) + ' s';
    if (s < 7200) return num(s / 60, 3) + ' min';
    return num(s / 3600, 3) + ' h';
}
const plural = (n, one, many) => `${n} ${n === 1 ? one : many || one + 's'}`;

/// Names shown in one line: what a reader cannot see is made visible.
const shown = s => s.replace(/[\u0000-\u001f\u007f\u0085\u2028\u2029\u202a-\u202e\u2066-\u2069]/g, '\u2423');
const nameOf = i => shown(data.shapes[i].name);
/// File name without folder and ending, for narrow places.
function shortName(i) {
    const name = nameOf(i), file = name.slice(name.lastIndexOf('/') + 1), dot = file.lastIndexOf('.');
    return (dot > 0 ? file.slice(0, dot) : file) || name;
}
function altOf(i) {
    const s = data.shapes[i];
    return s.picture && s.picture.alt ? shown(s.picture.alt) :
                                        `Shape ${nameOf(i)}` + (s.label ? `, class ${shown(s.label)}` : '');
}

// ---- pairs
const pairIndex = (i, j) => {
    if (i > j) [i, j] = [j, i];
    return count * i - i * (i + 1) / 2 + j - i - 1;
};
const distance = (i, j) => i === j ? 0 : data.distances[pairIndex(i, j)];
const hasErrors = data.errors.length > 0 || data.errors_left_out;
const errorOf = (i, j) => i === j || !data.errors.length ? null : data.errors[pairIndex(i, j)];
const isEstimate = (i, j) => i !== j && data.refined.length > 0 && !data.refined[pairIndex(i, j)];
function withError(i, j) {
    const d = distance(i, j), e = errorOf(i, j);
    if (!known(d)) return 'no trustworthy distance';
    return num(d, 4) + (known(e) ? ' ± ' + num(e, 2) : '') + (isEstimate(i, j) ? ' (estimate from coarse grids)' : '');
}
function neighboursOf(i) {
    if (data.neighbours.length) return data.neighbours[i];
    const others = [];
    for (let j = 0; j < count; ++j)
        if (j !== i && known(distance(i, j))) others.push(j);
    return others.sort((j, k) => distance(i, j) - distance(i, k));
}
const pathOf = new Map();
for (const p of data.paths) {
    const key = Math.min(p.a, p.b) + ' ' + Math.max(p.a, p.b), list = pathOf.get(key) || [];
    list.push(p);
    pathOf.set(key, list);
}
function storedPath(a, b) {
    const list = pathOf.get(Math.min(a, b) + ' ' + Math.max(a, b)) || [];
    return list.find(p => p.a === a) || list[0] || null;
}
/// A word of a shell command line, quoted so that the shell takes it literally.
function quoted(word) {
    if (/^[A-Za-z0-9_.,:/@%+=-]+$/.test(word)) return word;
    if (/[\u0000-\u001f\u007f]/.test(word)) {
        return '$\'' +
            word.replace(/[\\']/g, '\\$&')
                .replace(/[\u0000-\u001f\u007f]/g, c => '\\x' + c.charCodeAt(0).toString(16).padStart(2, '0')) +
            '\'';
    }
    return '\'' + word.replace(/'/g, '\'\\\'\'') + '\'';
}
function geodesicCommand(a, b) {
    const folder = data.collection && !data.collection.endsWith('/') ? data.collection + '/' : data.collection;
    const files = [a, b].map(i => folder + data.shapes[i].name);
    const out = `${shortName(a)}-${shortName(b)}.geodesic`.replace(/[^\p{L}\p{N}._-]+/gu, '_').replace(/^[-_]+/, '');
    const words = ['morphodesic', 'geodesic', ...data.geodesic_options, '--out', out];
    if (files.some(f => f.startsWith('-'))) words.push('--');
    return words.concat(files).map(quoted).join(' ');
}

// ---- groups: what the colours show, classes if they are known, else clusters
const labels = [...new Set(data.shapes.map(s => s.label).filter(l => l))].sort();
const clusters = data.clusterings.length ? data.clusterings[0].assignment : null;
const byClass = labels.length > 0 && labels.length < count;
const groupings = data.clusterings.map(({method, assignment}) => ({
    title: `clusters, ${shown(method)}`,
    names: [...new Set(assignment)].sort((x, y) => x - y).map(c => 'cluster ' + (c + 1)),
    of: i => 'cluster ' + (assignment[i] + 1)
}));
if (byClass)
    groupings.unshift({
        title: 'classes',
        names: labels.concat(data.shapes.some(s => !s.label) ? ['no class'] : []),
        of: i => data.shapes[i].label || 'no class'
    });
if (!groupings.length) groupings.push({title: 'nothing', names: ['all'], of: () => 'all'});
let grouping = groupings[0];
const groupOf = i => grouping.of(i);
const clusterOf = i => clusters ? clusters[i] + 1 : null;

/// A name with places where a line may end.
const breakable = text => text.split(/(?<=[/_.])/).flatMap((part, k) => k ? [el('wbr'), part] : [part]);

function announce(text) { document.getElementById('live').textContent = text; }

/// Studies of a given table have none.
const hasPictures = data.shapes.some(s => s.picture);

/// A picture of a shape; an empty box of the same size if it alone has none.
function thumbnail(i, size, decorative) {
    if (!hasPictures) return null;
    const p = data.shapes[i].picture;
    if (!p)
        return el(
            'span',
            {class: 'no-picture', style: `width:${size}px;height:${size}px`, role: 'img', 'aria-label': altOf(i)});
    return el(
        'img',
        {src: p.uri, width: size, height: size, class: 'thumb', alt: decorative ? '' : altOf(i), loading: 'lazy'});
}

/// A table with header cells; numeric columns are those whose title starts with "#". With the class "stack" each row
/// is a block on phones, whose last cell has a line of its own; roles keep it a table for screen readers there.
function table(caption, heads, rows, attributes) {
    const numeric = heads.map(h => h.startsWith('#'));
    const stacked = attributes && attributes.class === 'stack', role = name => stacked ? name : null;
    const head = k => stacked && numeric[k] ? heads[k].slice(1) : null;
    const cell = (content, k) => k === 0 ?
        el('th', {scope: 'row', role: role('rowheader'), 'data-head': head(0)}, content) :
        el('td', {class: numeric[k] ? 'num' : null, role: role('cell'), 'data-head': head(k)}, content);
    return el(
        'div', {class: 'scroll', tabindex: '0', role: 'group', 'aria-label': caption},
        el('table', {role: role('table'), ...attributes}, el('caption', {}, caption),
           el('thead', {role: role('rowgroup')},
              el('tr', {role: role('row')},
                 heads.map(
                     (h, k) => el(
                         'th', {scope: 'col', role: role('columnheader'), class: numeric[k] ? 'num' : null},
                         numeric[k] ? h.slice(1) : h)))),
           el('tbody', {role: role('rowgroup')}, rows.map(r => el('tr', {role: role('row')}, r.map(cell))))));
}
