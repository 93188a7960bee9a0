// ---- the panel of one pair: its geodesic as filmstrip and slider, with lengths, energies and certificate
const pair = {
    a: 0,
    b: Math.min(1, count - 1),
    listeners: [],
    timer: null
};

/// Chooses the two shapes to be shown; everything that marks a choice listens.
function choosePair(a, b, quiet) {
    if (a === b) return;
    pair.a = a;
    pair.b = b;
    renderPair();
    pair.listeners.forEach(f => f(a, b));
    if (!quiet)
        announce(
            `${nameOf(a)} and ${nameOf(b)}: distance ${withError(a, b)}` +
            (data.given_matrix  ? '' :
             storedPath(a, b) ? '; path shown' :
                                '; path not stored'));
}

function shapeSelect(id, label, which) {
    const options =
        data.shapes.map((s, i) => el('option', {value: i}, nameOf(i) + (s.label ? ` (${shown(s.label)})` : '')));
    return el(
        'label', {class: 'field'}, label,
        el('select', {
            id,
            change: e => {
                const value = Number(e.target.value), other = which === 'a' ? pair.b : pair.a;
                if (value === other) {
                    which === 'a' ? choosePair(value, pair.a) : choosePair(pair.b, value);
                    return;
                }
                which === 'a' ? choosePair(value, pair.b) : choosePair(pair.a, value);
            }
        },
           options));
}

function pairPanel() {
    return el(
        'section', {id: 'pair', 'aria-labelledby': 'pair-title'},
        el('h2', {id: 'pair-title'}, data.given_matrix ? 'Two shapes' : 'Geodesic between two shapes'),
        el('p', {class: 'hint screen'}, 'Click a cell of the matrix, or two shapes one after the other, or choose here.'),
        el('div', {class: 'fields'}, shapeSelect('pair-a', 'From', 'a'),
           el('button', {
               type: 'button',
               class: 'quiet',
               click: () => choosePair(pair.b, pair.a),
               'aria-label': 'Swap the two shapes'
           },
              '⇄'),
           shapeSelect('pair-b', 'to', 'b')),
        el('div', {id: 'pair-body'}));
}

function stopPlaying() {
    clearInterval(pair.timer);
    pair.timer = null;
}

function renderPair() {
    const body = document.getElementById('pair-body'), {a, b} = pair;
    if (!body) return;
    stopPlaying();
    document.getElementById('pair-a').value = a;
    document.getElementById('pair-b').value = b;
    const path = storedPath(a, b), rank = (i, j) => {
        const k = neighboursOf(i).indexOf(j);
        return k < 0 ? '–' : `${k + 1} of ${count - 1}`;
    };
    const remark = data.trust.not_converged.find(p => (p.a === a && p.b === b) || (p.a === b && p.b === a));
    body.replaceChildren(
        ...[el('div', {class: 'duel'}, el('figure', {}, thumbnail(a, 72), el('figcaption', {}, breakable(nameOf(a)))),
               el('p', {class: 'big'},
                  el('span', {class: 'number'}, known(distance(a, b)) ? num(distance(a, b), 4) : '–'),
                  known(errorOf(a, b)) && known(distance(a, b)) ?
                      el('span', {class: 'error'}, ` ± ${num(errorOf(a, b), 2)}`) :
                      null,
                  el('span', {class: 'what'},
                     isEstimate(a, b)      ? 'estimate from coarse grids' :
                         known(distance(a, b)) ? distanceName :
                                                 'no trustworthy distance')),
               el('figure', {}, thumbnail(b, 72), el('figcaption', {}, breakable(nameOf(b))))),
            el('p', {class: 'hint'},
               `Among the neighbours of the first shape the second is number ${rank(a, b)}; the other way round ${
                   rank(b, a)}.`),
            remark ? el('p', {class: 'notice'},
                        `Not converged: ${shown(remark.remark)}. Do not trust this distance beyond its error bar.`) :
                     null,
            path && path.frames.some(f => f.picture) ? filmstrip(path) : null, path ? pathNumbers(path) : null,
            !data.given_matrix && !(path && path.frames.some(f => f.picture)) ? recompute(a, b) : null]
            .filter(part => part));
    if (path) {
        const steps =
            path.frames.map((f, k) => ({value: f.deformation_energy, name: String(k)})).filter(s => known(s.value));
        steps.forEach((s, k) => {
            s.k = k;
        });
        const chart = document.getElementById('pair-energies');
        if (chart && steps.length)
            draw(
                chart,
                barSpec(steps, Math.min(420, body.clientWidth || 360), 'deformation energy', false, false, 'time step'),
                'Bar chart of the deformation energy per time step; the numbers are in the table below it.');
    }
}

function recompute(a, b) {
    const command = geodesicCommand(a, b);
    return el(
        'div', {class: 'recompute'},
        el('p', {}, 'The pictures of this path are not stored in the report. This command computes them:'),
        el('pre', {tabindex: '0'}, el('code', {}, command)), copyButton(command));
}

function copyButton(text) {
    return el(
        'button', {
            type: 'button',
            class: 'quiet',
            click: async e => {
                try {
                    await navigator.clipboard.writeText(text);
                    e.target.textContent = 'Copied';
                    announce('Copied');
                } catch {
                    announce('Copying is not allowed here; select the command and copy it.');
                    e.target.textContent = 'Select and copy';
                }
            }
        },
        'Copy');
}

function filmstrip(path) {
    const frames = path.frames, last = frames.length - 1, from = nameOf(path.a), to = nameOf(path.b);
    const stage = el('img', {class: 'stage', alt: ''}), at = el('output', {for: 'time'
                                                        });
    const slider =
        el('input',
           {type: 'range', id: 'time', min: 0, max: last, step: 1, value: 0, input: () => show(Number(slider.value))});
    const altFor = k => frames[k].picture && frames[k].picture.alt ?
        shown(frames[k].picture.alt) :
        `Step ${k} of ${last} on the way from ${from} to ${to}`;
    const buttons = frames.map(
        (f, k) =>
            el('button', {
                type: 'button',
                class: 'frame',
                click: () => {
                    stopPlaying();
                    play.textContent = 'Play';
                    show(k);
                },
                'aria-label': `Show time ${num(f.time)}`
            },
               f.picture ? el('img', {src: f.picture.uri, alt: altFor(k)}) : '–', el('span', {}, num(f.time))));
    const play =
        el('button', {
            type: 'button',
            class: 'quiet',
            click: () => {
                if (pair.timer) {
                    stopPlaying();
                    play.textContent = 'Play';
                    return;
                }
                let k = Number(slider.value) >= last ? -1 : Number(slider.value), way = 1;
                play.textContent = 'Pause';
                pair.timer = setInterval(() => {
                    k += way;
                    if (k >= last) way = -1;
                    if (k <= 0) way = 1;
                    show(Math.max(0, Math.min(last, k)));
                }, 350);
            }
        },
           'Play');
    function show(k) {
        const f = frames[k];
        slider.value = k;
        slider.setAttribute('aria-valuetext', `time ${num(f.time)}`);
        at.textContent = `t = ${num(f.time)}`;
        if (f.picture) {
            stage.src = f.picture.uri;
            stage.alt = altFor(k);
        }
        buttons.forEach((b, j) => b.setAttribute('aria-pressed', String(j === k)));
    }
    show(0);
    const bar = path.colour_bar, colours = bar.colours.filter(c => /^#[0-9a-fA-F]{6}$/.test(c));
    return el(
        'div', {class: 'film', id: 'film'},
        el('div', {class: 'strip', role: 'group', 'aria-label': `Filmstrip from ${from} to ${to}`}, buttons),
        el('div', {class: 'player'}, stage,
           el('div', {class: 'controls'}, play,
              el('label',
                 {for: 'time'
                 },
                 'Time'),
              slider, at)),
        path.a !== pair.a ?
            el('p', {class: 'hint'},
               'This path was computed in the other direction: time runs from the second shape to the first.') :
            null,
        colours.length ? el('div', {
            class: 'colour-bar',
            role: 'img',
            'aria-label': `Colours: ${bar.quantity} from ${num(bar.low)} to ${num(bar.high)} ${bar.unit}`
        },
                            el('span', {}, `${bar.quantity}${bar.unit ? ' [' + bar.unit + ']' : ''}`),
                            el('span', {class: 'ramp'}, el('span', {}, num(bar.low)),
                               el('i', {style: `background:linear-gradient(to right, ${colours.join(', ')})`}),
                               el('span', {}, num(bar.high)))) :
                         null);
}

function pathNumbers(path) {
    const rows = [
        ['path length', num(path.path_length, 5) + (known(path.error) ? ` ± ${num(path.error, 2)}` : '')],
        ['length for h → 0 (extrapolated)', num(path.extrapolated_length, 5)],
        ['path energy', num(path.path_energy, 5)], ['total energy', num(path.total_energy, 5)],
        [
            'certificate: min det Dφ ≥',
            known(path.min_det) ? num(path.min_det, 4) + (path.min_det > 0 ? ' (one-to-one)' : ' (not certified)') : '–'
        ],
        ['termination', path.termination.replace('_', ' ') + (path.message ? ': ' + shown(path.message) : '')],
        ['grid level, time steps', `${path.level}, ${path.time_steps}`], ['computed in', duration(path.seconds)],
        ['motion removed before', path.motion ? shown(path.motion) : 'none']
    ];
    return el(
        'div', {},
        el('dl', {class: 'numbers'},
           rows.filter(r => r[1] !== '–').map(([k, v]) => el('div', {}, el('dt', {}, k), el('dd', {}, v)))),
        el('div', {id: 'pair-energies', class: 'chart'}),
        el('details', {}, el('summary', {}, 'Energies per step as a table'),
           table(
               'Energies per step', ['step', '#time', '#deformation energy', '#mismatch energy'],
               path.frames.map((f, k) => [k, num(f.time), num(f.deformation_energy), num(f.mismatch_energy)]))));
}
