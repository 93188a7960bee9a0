// ---- putting the page together
const redraws = [];

function start() {
    const main = document.getElementById('main'), explore = [
        glanceSection(), matrixSection(), count > 1 ? el('div', {class: 'aside'}, pairPanel()) : null,
        embeddingSection(), neighbourSection()
    ];
    main.append(summarySection(), el('div', {class: 'explore'}, explore));
    main.append(...[classSection(), trustSection(), volumeSection(), compareSection(), repeatSection()].filter(s => s));
    const titles = [...main.querySelectorAll('section > h2')].filter(h => h.parentNode.id !== 'pair');
    document.getElementById('contents')
        .append(el('ul', {}, titles.map(h => el('li', {}, el('a', {href: '#' + h.parentNode.id}, h.textContent)))));
    document.getElementById('footer').append(el(
        'p', {},
        'Made by morphodesic. ' +
            (data.given_matrix ?
                 'Distances are those of the table. ' :
                 'Distances are path lengths of discrete geodesics in the space of viscous-fluid objects (Wirth, Bar, Rumpf, Sapiro). ') +
            'Charts: Vega, University of Washington Interactive Data Lab.'));
    if (data.errors_left_out) {
        document.getElementById('pair').append(
            el('p', {class: 'hint'}, 'The error bars of so many pairs are not in this file; pairs.csv has them.'));
    }
    if (data.paths_left_out) {
        document.getElementById('pair').append(el(
            'p', {class: 'hint'},
            `${
                plural(
                    data.paths_left_out,
                    'stored path')} would make this file larger than 20 MB and is not shown here; the study folder has it.`));
    }
    if (count > 1) {
        const first = data.paths.find(p => p.frames.some(f => f.picture));
        first ? choosePair(first.a, first.b, true) : choosePair(0, neighboursOf(0)[0] ?? 1, true);
    }
}

/// Charts are drawn one after the other from the top, so that a large study shows its first charts at once.
async function drawAll() {
    for (const f of redraws) await f();
}

function themes() {
    const button = document.getElementById('theme'), dark = matchMedia('(prefers-color-scheme: dark)');
    const isDark = () => (document.documentElement.dataset.theme || (dark.matches ? 'dark' : 'light')) === 'dark';
    const show = () => {
        button.textContent = isDark() ? 'Light' : 'Dark';
        button.setAttribute('aria-pressed', String(isDark()));
    };
    button.setAttribute('aria-label', 'Dark colours');
    button.addEventListener('click', () => {
        document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
        show();
    });
    dark.addEventListener('change', show);
    show();
}

themes();
start();
drawAll().then(() => {
    document.documentElement.dataset.ready = 'yes';
    let width = innerWidth, timer = null;
    addEventListener('resize', () => {
        clearTimeout(timer);
        timer = setTimeout(() => {
            if (innerWidth !== width) {
                width = innerWidth;
                drawAll();
            }
        }, 200);
    });
    addEventListener('beforeprint', () => document.querySelectorAll('details').forEach(d => {
        if (!d.open) {
            d.dataset.closed = '1';
            d.open = true;
        }
    }));
    addEventListener('afterprint', () => document.querySelectorAll('details[data-closed]').forEach(d => {
        d.open = false;
        delete d.dataset.closed;
    }));
});
