// The script of a model that moves (moving_view.h): reads its shapes, nodes and keys, composes where its nodes stand at
// a time as io::placed_nodes does, and keeps the time: slider, buttons, keys, plots, labels.
#include "report/moving_view.h"

namespace gonio::report {

const std::string_view moving_script = R"js(
const product = (a, b) =>
  [0, 0, 0, 3, 3, 3, 6, 6, 6].map((r, i) => a[r] * b[i % 3] + a[r + 1] * b[i % 3 + 3] + a[r + 2] * b[i % 3 + 6]);
const applied = (m, v) => [0, 3, 6].map(r => m[r] * v[0] + m[r + 1] * v[1] + m[r + 2] * v[2]);
const matrixOf = ([w, x, y, z]) => [
  1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
  2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
  2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
const aboutZ = a => [Math.cos(a), -Math.sin(a), 0, Math.sin(a), Math.cos(a), 0, 0, 0, 1];
const readModel = (box, bytes) => {
  const held = box.querySelector('.model');
  if (!held) return null;
  const floats = text => new Float32Array(bytes(text).buffer);
  const data = JSON.parse(held.textContent), keys = box.querySelector('.times');
  const times = floats(keys.dataset.times), angles = floats(keys.textContent), count = angles.length / times.length;
  const palette = data.palette.map(c => [1, 3, 5].map(i => parseInt(c.slice(i, i + 2), 16) / 255));
  const nodes = data.nodes.map(([parent, hinge, shape, colour, place, label, changes]) =>
    ({parent, hinge, shape, colour, label: label || '', changes: changes || [], origin: place.slice(0, 3),
      turn: matrixOf(place.slice(3))}));
  nodes.forEach(n => { n.moves = n.hinge >= 0 || n.parent >= 0 && nodes[n.parent].moves; });
  const anglesAt = time => {
    let low = 0, high = times.length - 1;
    if (time <= times[0] || high === 0) return angles.slice(0, count);
    if (time >= times[high]) return angles.slice(high * count);
    while (high - low > 1) {
      const middle = low + high >> 1;
      if (times[middle] <= time) low = middle; else high = middle;
    }
    const share = (time - times[low]) / (times[high] - times[low]);
    return Array.from({length: count},
      (_, h) => angles[low * count + h] + share * (angles[high * count + h] - angles[low * count + h]));
  };
  const place = time => {
    const at = anglesAt(time);
    for (const n of nodes) {
      if (n.q && !n.moves) continue;
      const above = n.parent >= 0 ? nodes[n.parent] : null;
      n.q = above ? product(above.q, n.turn) : n.turn;
      n.o = above ? applied(above.q, n.origin).map((v, i) => v + above.o[i]) : n.origin;
      if (n.hinge >= 0) n.q = product(n.q, aboutZ(at[n.hinge]));
    }
    return nodes;
  };
  const colourAt = (n, time) => {
    let colour = n.colour;
    for (const [from, to] of n.changes) if (from <= time) colour = to;
    return palette[colour];
  };
  const shapes = [...box.querySelectorAll('.shape')].map(s => {
    const low = s.dataset.low.split(' ').map(Number), codes = new Uint16Array(bytes(s.textContent).buffer);
    const positions = Float32Array.from(codes, (c, i) => low[i % 3] + s.dataset.side * c / 65535);
    const indices = bytes(s.dataset.indices).buffer;
    return {positions, indices: Uint32Array.from(s.dataset.wide === '2' ? new Uint16Array(indices)
      : new Uint32Array(indices))};
  });
  return {nodes, words: data.words, end: times[times.length - 1], place, colourAt, shapes};
};
// Names beside what they name, those that would cover another left out: what moves comes first.
const makeNames = (stage, model) => {
  const all = document.createElement('div');
  all.className = 'names';
  all.setAttribute('aria-hidden', 'true');
  stage.append(all);
  const named = model.nodes.filter(n => n.label).sort((a, b) => b.moves - a.moves);
  for (const n of named) {
    n.tag = all.appendChild(document.createElement('span'));
    n.tag.textContent = n.label;
  }
  return {all, count: named.length, put: (project, wide, high) => {
    const taken = [];
    for (const n of named) {
      const [x, y] = project(n.o), w = 7 * n.label.length + 8;
      const free = x > 0 && y > 8 && x + w < wide && y < high - 8 &&
        taken.every(([a, b, c]) => x + w < a || a + c < x || Math.abs(y - b) > 15);
      if (free) taken.push([x, y, w]);
      n.tag.style.visibility = free ? '' : 'hidden';
      n.tag.style.transform = 'translate(' + (x + 6).toFixed(1) + 'px,' + (y - 9).toFixed(1) + 'px)';
    }
  }};
};
// A line at the time that is shown in every plot over time; a click there leads to that time.
const makeCursors = seek => [...document.querySelectorAll('svg[data-time]')].map(svg => {
  const [low, high, left, right, top, floor] = svg.dataset.time.split(' ').map(Number);
  const line = document.createElementNS(svg.namespaceURI, 'path');
  line.setAttribute('class', 'cursor');
  svg.append(line);
  svg.addEventListener('click', e => {
    const at = new DOMPoint(e.clientX, e.clientY).matrixTransform(svg.getScreenCTM().inverse());
    if (at.x >= left && at.x <= right) seek(low + (at.x - left) / (right - left) * (high - low));
  });
  return time => {
    const x = left + (time - low) / (high - low) * (right - left);
    line.setAttribute('d', 'M' + x.toFixed(2) + ' ' + top + 'V' + floor);
  };
});
const listenToKeys = (box, range, t) => {
  range.addEventListener('input', () => t.seek(+range.value));
  range.addEventListener('keydown', e => {
    const by = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[e.key];
    if (by) t.seek(t.now() + by * t.end / 200);
    else if (e.key === 'Home') t.seek(0);
    else if (e.key === 'End') t.seek(t.end);
    else return;
    e.preventDefault();
  });
  box.addEventListener('keydown', e => {
    if (e.key === ' ' && !e.target.closest('button,select,label')) t.toggle();
    else if (e.key === 'PageUp') t.back();
    else if (e.key === 'PageDown') t.on();
    else return;
    e.preventDefault();
  });
};
const makeTimeline = (box, model, draw, controls) => {
  let time = Math.min(+box.dataset.start || 0, model.end), playing = false, last = 0;
  const make = (tag, set, into) => into.appendChild(Object.assign(document.createElement(tag), set));
  const button = (text, name, action) => {
    const b = make('button', {type: 'button', textContent: text}, controls);
    b.setAttribute('aria-label', name);
    b.addEventListener('click', action);
    return b;
  };
  const stops = model.words.filter(w => w[2]);
  const back = () => { const s = stops.filter(w => w[0] < time - 1e-3).pop(); seek(s ? s[0] : 0); };
  const on = () => { const s = stops.find(w => w[0] > time + 1e-3); seek(s ? s[0] : model.end); };
  const play = button('Play', 'Play', () => toggle());
  if (stops.length) button('\u25c0', 'To the view before', back);
  const range = make('input', {type: 'range', min: 0, max: model.end, step: 'any', value: time}, controls);
  range.setAttribute('aria-label', 'Time of ' + box.dataset.name);
  if (stops.length) button('\u25b6', 'To the next view', on);
  const pace = make('select', {}, controls);
  pace.setAttribute('aria-label', 'Pace');
  for (const p of [1, 5, 20, 100]) make('option', {value: p, textContent: p + '\u00d7'}, pace);
  pace.value = [1, 5, 20, 100].find(p => model.end / p <= 60) || 100;
  const output = make('output', {}, controls);
  const seek = to => {
    time = Math.min(Math.max(to, 0), model.end);
    range.value = time;
    let at = '';
    for (const w of model.words) if (w[0] <= time + 1e-6) at = w[1];
    const said = time.toFixed(1) + ' s of ' + model.end.toFixed(1) + ' s' + (at && ': ' + at);
    output.value = said;
    range.setAttribute('aria-valuetext', said);
    box.dataset.time = time.toFixed(3);
    for (const put of cursors) put(time);
    draw();
  };
  const cursors = makeCursors(to => seek(to));
  const step = now => {
    if (!playing) return;
    if (last) seek(time + (now - last) / 1000 * +pace.value);
    last = now;
    if (time >= model.end) toggle();
    else requestAnimationFrame(step);
  };
  const toggle = () => {
    playing = !playing, last = 0;
    if (playing && time >= model.end) seek(0);
    play.textContent = playing ? 'Pause' : 'Play';
    play.setAttribute('aria-label', play.textContent);
    if (playing) requestAnimationFrame(step);
  };
  listenToKeys(box, range, {now: () => time, end: model.end, seek, toggle, back, on});
  return {now: () => time, seek};
};
)js";

}  // namespace gonio::report
