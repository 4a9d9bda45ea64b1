// Views of points that move: a canvas that one turns, a slider over the frames, switches for what is drawn. Without the
// script the drawing of one frame stays.
#include "report/motion_style.h"

namespace gonio::report {

const std::string_view motion_style = R"css(
.motion{width:100%}
.motion svg,.motion canvas{display:block;width:100%;height:auto;aspect-ratio:4/3;
background:var(--fill);border-radius:2px}
.motion canvas{cursor:grab;touch-action:pan-y}
.motion canvas:active{cursor:grabbing}
.motion canvas:focus-visible{outline:2px solid var(--accent);outline-offset:2px}
.motion svg path{stroke-width:1}
.motion svg .grid{stroke:var(--soft);opacity:.45}
.motion svg .truth{fill:none;stroke:var(--ink);stroke-width:1}
.motion .controls{display:flex;flex-wrap:wrap;align-items:center;gap:.4rem .9rem;margin:.5rem 0;font-size:.8125rem;
color:var(--soft)}
.motion .controls button{font:inherit;color:var(--ink);background:var(--fill);border:1px solid var(--line);
border-radius:3px;padding:.2rem .7rem;min-width:4.2rem;cursor:pointer}
.motion .controls input[type=range]{flex:1;min-width:8rem;accent-color:var(--accent)}
.motion .controls output{flex-basis:100%}
.motion .controls label{display:inline-flex;align-items:center;gap:.3rem}
.motion .scale{margin:.4rem 0 0;max-width:none}
@media print{.motion .controls{display:none}}
)css";

const std::string_view motion_script = R"js(
for (const box of document.querySelectorAll('.motion')) {
  const d = box.dataset, numbers = text => text ? text.split(' ').map(Number) : [];
  const frames = numbers(d.frames), count = +d.points, links = numbers(d.links), origin = numbers(d.origin);
  const middle = numbers(d.middle), start = numbers(d.turn), full = +d.full, colours = d.colours.split(',');
  const digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';
  const value = {};
  for (let i = 0; i < 64; ++i) value[digits[i]] = i;
  const xyz = new Float32Array(d.codes.length / 2);
  for (let i = 0; i < xyz.length; ++i) {
    const code = 64 * value[d.codes[2 * i]] + value[d.codes[2 * i + 1]];
    xyz[i] = code === 4095 ? NaN : origin[i % 3] + +d.step * code - middle[i % 3];
  }
  let turn = start.slice(), frame = frames.length >> 1, playing = 0, last = 0;
  const make = (tag, set, into) => into.appendChild(Object.assign(document.createElement(tag), set));
  const still = box.querySelector('svg'), canvas = document.createElement('canvas');
  still.replaceWith(canvas);
  canvas.tabIndex = 0;
  canvas.setAttribute('role', 'img');
  const controls = document.createElement('div');
  controls.className = 'controls';
  canvas.after(controls);
  const button = make('button', {type: 'button', textContent: 'Play'}, controls);
  const range = make('input', {type: 'range', min: 0, max: frames.length - 1, step: 1, value: frame}, controls);
  range.setAttribute('aria-label', 'Frame of ' + d.name);
  const shown = {};
  for (const [key, text] of [['truth', 'truth'], ['found', 'reconstruction'], ['lines', 'lines']]) {
    const label = make('label', {}, controls);
    shown[key] = make('input', {type: 'checkbox', checked: true}, label);
    label.append(text);
    shown[key].addEventListener('change', () => draw());
  }
  const output = make('output', {}, controls);
  const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const draw = () => {
    const wide = canvas.clientWidth, high = wide * 0.75, ratio = window.devicePixelRatio || 1;
    if (!wide) return;
    canvas.width = Math.round(wide * ratio), canvas.height = Math.round(high * ratio);
    const g = canvas.getContext('2d'), scale = (high / 2 - 24 * wide / 560) / +d.radius, size = wide / 560;
    g.scale(ratio, ratio);
    const seen = [], squares = [];
    for (let set = 0; set < 2; ++set)
      for (let p = 0; p < count; ++p) {
        const i = 3 * ((2 * frame + set) * count + p), x = xyz[i], y = xyz[i + 1], z = xyz[i + 2];
        const row = k => turn[k] * x + turn[k + 1] * y + turn[k + 2] * z;
        seen.push([wide / 2 + scale * row(0), high / 2 - scale * row(3), row(6) / +d.radius, x, y, z]);
      }
    const line = (a, b) => { g.beginPath(); g.moveTo(a[0], a[1]); g.lineTo(b[0], b[1]); g.stroke(); };
    const dot = (a, r) => { g.beginPath(); g.arc(a[0], a[1], r * size * (1 + 0.35 * a[2]), 0, 6.2832); };
    g.lineWidth = 1;
    if (shown.truth.checked) {
      g.strokeStyle = style('--soft');
      g.globalAlpha = 0.45;
      for (let k = 0; k < links.length; k += 2) line(seen[links[k]], seen[links[k + 1]]);
      g.globalAlpha = 1;
    }
    const order = [...Array(count).keys()].sort((a, b) => seen[a][2] - seen[b][2]);
    for (const p of order) {
      const q = seen[p], x = seen[count + p], away = Math.hypot(x[3] - q[3], x[4] - q[4], x[5] - q[5]);
      if (away >= 0) squares.push(away * away);
      const most = colours.length - 1;
      const colour = colours[Math.min(most, Math.round(away / full * most))] || 'transparent';
      g.fillStyle = colour;
      if (shown.lines.checked && away >= 0) { g.strokeStyle = colour; line(q, x); }
      g.strokeStyle = style('--ink');
      if (shown.truth.checked && q[0] === q[0]) { dot(q, 3); g.stroke(); }
      if (shown.found.checked && x[0] === x[0]) { dot(x, 3.2); g.fill(); }
    }
    const rms = Math.sqrt(squares.reduce((a, b) => a + b, 0) / squares.length);
    output.value = 'frame ' + frames[frame] + ': root mean square ' + (squares.length ? rms.toPrecision(3) : '\u2013') +
      ' ' + d.unit;
    canvas.setAttribute('aria-label', d.name + ', ' + output.value);
    box.dataset.drawn = frames[frame];
  };
  const rotate = (across, up) => {
    const c = Math.cos(across), s = Math.sin(across), e = Math.cos(up), f = Math.sin(up), t = turn;
    const r = [0, 1, 2].map(k => [c * t[k] + s * t[6 + k], t[3 + k], c * t[6 + k] - s * t[k]]);
    for (let k = 0; k < 3; ++k)
      turn[k] = r[k][0], turn[3 + k] = e * r[k][1] - f * r[k][2], turn[6 + k] = f * r[k][1] + e * r[k][2];
    draw();
  };
  const show = f => { frame = f; range.value = f; draw(); };
  const step = now => {
    if (!playing) return;
    if (now - last > 80) { last = now; show((frame + 1) % frames.length); }
    requestAnimationFrame(step);
  };
  button.addEventListener('click', () => {
    playing = !playing;
    button.textContent = playing ? 'Pause' : 'Play';
    if (playing) requestAnimationFrame(step);
  });
  range.addEventListener('input', () => show(+range.value));
  canvas.addEventListener('pointerdown', e => canvas.setPointerCapture(e.pointerId));
  canvas.addEventListener('pointermove', e => {
    if (e.buttons & 1) rotate(e.movementX * 0.01, e.movementY * 0.01);
  });
  canvas.addEventListener('dblclick', () => { turn = start.slice(); draw(); });
  canvas.addEventListener('keydown', e => {
    const by = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]}[e.key];
    if (by) { e.preventDefault(); rotate(...by); }
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
  new ResizeObserver(draw).observe(canvas);
  draw();
}
)js";

}  // namespace gonio::report
