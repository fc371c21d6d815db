'use strict';
// Tables that sort by a click, and the player. On <body>, data-ready says that all of it ran: "page", or "player" with
// data-drawn, the edges drawn; data-failed what did not.
window.addEventListener('error', event => { document.body.dataset.failed = event.message; });

for (const table of document.querySelectorAll('table.sortable')) {
    const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
    const value = (row, column) => {
        const cell = row.cells[column], text = cell.dataset.value ?? cell.textContent.trim();
        return text === '–' || text === '' ? null : isNaN(text) ? text : Number(text);
    };
    heads.forEach((head, column) => head.querySelector('button').addEventListener('click', () => {
        const down = head.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
        heads.forEach(other => other.setAttribute('aria-sort', 'none'));
        head.setAttribute('aria-sort', down > 0 ? 'ascending' : 'descending');
        const order = (a, b) => {
            const x = value(a, column), y = value(b, column);
            if (x === null || y === null) return (x === null) - (y === null);  // what is not there is last
            return down * (typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y)));
        };
        body.append(...[...body.rows].sort(order));
    }));
}

function startPlayer(data) {
    const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
    const words = text => {
        const b = bytes(text), out = new Uint16Array(b.length / 2);
        for (let k = 0; k < out.length; ++k) out[k] = b[2 * k] | b[2 * k + 1] << 8;
        return out;
    };
    const {frames, strands, particles} = data;
    const each = strands * particles, step = data.size.map(s => s / 65535), middle = data.size.map(s => s / 2);
    const runs = data.runs.map(run => ({
        positions: words(run.positions), saturation: run.saturation === null ? null : bytes(run.saturation),
        expected: run.expected === null ? null : bytes(run.expected)
    }));
    const solids = data.solids.map(words);
    const panels = [...document.querySelectorAll('.panels canvas')];
    const slider = document.getElementById('frame'), play = document.getElementById('play');
    const when = document.getElementById('when'), scale = document.getElementById('scale').children;
    const modes = [...document.querySelectorAll('.choice button')];

    // ---- what is seen

    const start = {yaw: 0.5, pitch: 0.12, zoom: 1};
    const view = {...start};
    let mode = 'saturation', frame = 0, playing = false, since = 0, waiting = false;
    slider.max = frames - 1;

    // ---- colours: shades of a ramp, paler the farther away

    const shades = 12, layers = 14;
    const css = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
    const rgb = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
    const mix = (a, b, t) => a.map((x, k) => x + (b[k] - x) * t);
    const text = c => `rgb(${c.map(Math.round).join()})`;
    const ramp = t => {
        if (mode === 'saturation') return mix(rgb(css('dry')), rgb(css('wet')), t);
        return t < 0.5 ? mix(rgb(css('near')), rgb(css('middle')), 2 * t) : mix(rgb(css('middle')), rgb(css('far')), 2 * t - 1);
    };
    let palette = [];
    function paint() {
        const paper = rgb(css('raised'));
        palette = [];
        for (let layer = 0; layer < layers; ++layer)
            for (let shade = 0; shade < shades; ++shade)
                palette.push(text(mix(paper, ramp(shade / (shades - 1)), 0.42 + 0.58 * layer / (layers - 1))));
        const bar = scale[1].getContext('2d');
        for (let x = 0; x < 120; ++x) {
            bar.fillStyle = text(ramp(x / 119));
            bar.fillRect(x, 0, 1, 8);
        }
        scale[0].textContent = mode === 'saturation' ? 'dry' : '0';
        scale[2].textContent = mode === 'saturation' ? 'wet' : data.error_mm + ' mm or more';
    }

    // ---- drawing

    const x = new Float32Array(each), y = new Float32Array(each), depth = new Float32Array(each);
    const edges = strands * (particles - 1), key = new Uint16Array(edges), sorted = new Uint32Array(edges);

    // Positions (16 bit) from `from` on, `count` of them, to pixels and depth toward the eye.
    function project(positions, from, count, canvas, x, y, depth) {
        const cy = Math.cos(view.yaw), sy = Math.sin(view.yaw), cp = Math.cos(view.pitch), sp = Math.sin(view.pitch);
        const radius = Math.hypot(...middle), eye = 3.4 * radius;
        // Hair is round: the corners of its box are empty.
        const fit = view.zoom * 0.47 * Math.min(canvas.width / (1.12 * Math.max(middle[0], middle[2])), canvas.height / middle[1]);
        for (let k = 0, at = 3 * from; k < count; ++k, at += 3) {
            const px = positions[at] * step[0] - middle[0], py = positions[at + 1] * step[1] - middle[1],
                  pz = positions[at + 2] * step[2] - middle[2];
            const rx = cy * px - sy * pz, rz = sy * px + cy * pz;
            const ry = cp * py - sp * rz, toward = sp * py + cp * rz;
            const s = fit * eye / Math.max(0.2 * radius, eye - toward);
            x[k] = canvas.width / 2 + s * rx;
            y[k] = canvas.height / 2 - s * ry;
            depth[k] = 0.5 + 0.5 * toward / radius;
        }
    }
    const layerOf = d => Math.max(0, Math.min(layers - 1, Math.floor(d * layers)));

    // What a solid covers: the convex hull of its points (Andrew 1979).
    function hull(x, y, count) {
        const order = [...Array(count).keys()].sort((a, b) => x[a] - x[b] || y[a] - y[b]), out = [];
        for (const way of [order, order.slice().reverse()]) {
            const start = out.length;
            for (const k of way) {
                while (out.length - start >= 2) {
                    const a = out[out.length - 2], b = out[out.length - 1];
                    if ((x[b] - x[a]) * (y[k] - y[a]) - (y[b] - y[a]) * (x[k] - x[a]) > 0) break;
                    out.pop();
                }
                out.push(k);
            }
            out.pop();
        }
        return out;
    }

    function solidsIn(canvas) {
        return solids.map(points => {
            const n = points.length / 3 / frames;
            const x = new Float32Array(n), y = new Float32Array(n), depth = new Float32Array(n);
            project(points, frame * n, n, canvas, x, y, depth);
            return {outline: hull(x, y, n), x, y, layer: layerOf(depth.reduce((a, b) => a + b, 0) / n)};
        });
    }

    function drawSolid(context, solid) {
        const xs = solid.outline.map(k => solid.x[k]), ys = solid.outline.map(k => solid.y[k]);
        const left = Math.min(...xs), right = Math.max(...xs), top = Math.min(...ys), bottom = Math.max(...ys);
        const reach = Math.max(right - left, bottom - top);
        const light = context.createRadialGradient(left + 0.36 * (right - left), top + 0.3 * (bottom - top), 0.05 * reach,
                                                   (left + right) / 2, (top + bottom) / 2, 0.62 * reach);
        light.addColorStop(0, css('solid-light'));
        light.addColorStop(1, css('solid-dark'));
        context.fillStyle = light;
        context.beginPath();
        xs.forEach((px, k) => context.lineTo(px, ys[k]));
        context.fill();
    }

    function shadeOf(run, k, at, reference) {
        if (mode === 'saturation') {
            if (run.saturation === null) return 0;
            const still = run.saturation.length === each;
            return run.saturation[still ? k : frame * each + k] / 255;
        }
        if (mode === 'expected') return run.expected === null ? 0 : run.expected[frame * each + k] / 255;
        const dx = (run.positions[at] - reference[at]) * step[0], dy = (run.positions[at + 1] - reference[at + 1]) * step[1],
              dz = (run.positions[at + 2] - reference[at + 2]) * step[2];
        return Math.min(1, 1000 * Math.sqrt(dx * dx + dy * dy + dz * dz) / data.error_mm);
    }

    function draw(run, canvas) {
        const pixel = Math.min(2, window.devicePixelRatio || 1);
        const width = Math.max(1, Math.round(canvas.clientWidth * pixel)), height = Math.max(1, Math.round(canvas.clientHeight * pixel));
        if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
        const context = canvas.getContext('2d'), reference = runs[0].positions;
        context.clearRect(0, 0, width, height);
        project(run.positions, frame * each, each, canvas, x, y, depth);
        // Edges by layer, then shade: few strokes, the nearest last.
        const count = new Uint32Array(layers * shades + 1);
        for (let s = 0, e = 0; s < strands; ++s)
            for (let i = 1; i < particles; ++i, ++e) {
                const k = s * particles + i;
                const shade = Math.round((shades - 1) * shadeOf(run, k, 3 * (frame * each + k), reference));
                key[e] = layerOf(0.5 * (depth[k] + depth[k - 1])) * shades + shade;
                ++count[key[e] + 1];
            }
        for (let k = 0; k < layers * shades; ++k) count[k + 1] += count[k];
        const next = count.slice();
        for (let e = 0; e < edges; ++e) sorted[next[key[e]]++] = e;
        const shown = solidsIn(canvas);
        context.lineCap = context.lineJoin = 'round';
        let drawn = 0;
        for (let group = 0; group < layers * shades; ++group) {
            const layer = Math.floor(group / shades);
            if (group % shades === 0)
                for (const solid of shown)
                    if (solid.layer === layer) drawSolid(context, solid);
            if (count[group] === count[group + 1]) continue;
            context.beginPath();
            for (let n = count[group], last = -2; n < count[group + 1]; ++n) {
                const e = sorted[n], first = e + Math.floor(e / (particles - 1));  // its particle nearer to the root
                if (e !== last + 1 || e % (particles - 1) === 0) context.moveTo(x[first], y[first]);
                context.lineTo(x[first + 1], y[first + 1]);
                last = e;
                ++drawn;
            }
            context.strokeStyle = palette[group];
            context.lineWidth = pixel * (0.75 + 0.55 * layer / (layers - 1)) * Math.sqrt(Math.max(1, view.zoom));
            context.stroke();
        }
        return drawn;
    }

    function drawAll() {
        waiting = false;
        const shown = data.first_frame + frame * data.frame_step;
        when.textContent = `frame ${shown}, ${(shown / data.fps).toFixed(2)} s`;
        slider.value = frame;
        return runs.reduce((sum, run, k) => sum + draw(run, panels[k]), 0);
    }
    function soon() {
        if (!waiting) requestAnimationFrame(drawAll);
        waiting = true;
    }

    // ---- hands

    function advance(now) {
        if (!playing) return;
        const passed = Math.floor((now - since) / 1000 * data.fps / data.frame_step);
        if (passed > 0) {
            frame = (frame + passed) % frames;
            since += passed * 1000 * data.frame_step / data.fps;
            drawAll();
        }
        requestAnimationFrame(advance);
    }
    function setPlaying(on) {
        playing = on && frames > 1;
        play.textContent = playing ? 'Pause' : 'Play';
        since = performance.now();
        if (playing) requestAnimationFrame(advance);
    }
    play.addEventListener('click', () => setPlaying(!playing));
    slider.addEventListener('input', () => {
        setPlaying(false);
        frame = Number(slider.value);
        soon();
    });
    for (const button of modes)
        button.addEventListener('click', () => {
            mode = button.dataset.mode;
            modes.forEach(b => b.setAttribute('aria-pressed', b === button));
            paint();
            soon();
        });
    for (const canvas of panels) {
        canvas.addEventListener('pointerdown', event => canvas.setPointerCapture(event.pointerId));
        canvas.addEventListener('pointermove', event => {
            if (!event.buttons) return;
            view.yaw -= event.movementX * 0.008;
            view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + event.movementY * 0.008));
            soon();
        });
        canvas.addEventListener('wheel', event => {
            event.preventDefault();
            view.zoom = Math.max(0.3, Math.min(12, view.zoom * Math.exp(-0.0015 * event.deltaY)));
            soon();
        }, {passive: false});
        canvas.addEventListener('dblclick', () => {
            Object.assign(view, start);
            soon();
        });
        canvas.addEventListener('keydown', event => {
            const turn = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]}[event.key];
            if (!turn) return;
            event.preventDefault();
            view.yaw += turn[0];
            view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + turn[1]));
            soon();
        });
    }
    new ResizeObserver(soon).observe(document.getElementById('player'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
        paint();
        soon();
    });

    // Without a run that is wet, its error says more.
    if (runs.every(run => run.saturation === null)) modes[1].click();
    paint();
    return drawAll();
}

const held = document.getElementById('player-data');
if (held) document.body.dataset.drawn = startPlayer(JSON.parse(held.textContent));
document.body.dataset.ready = held ? 'player' : 'page';
