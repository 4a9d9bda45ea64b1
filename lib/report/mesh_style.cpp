// Views of surfaces: a WebGL canvas that one turns and brings nearer, buttons for the surfaces. Without script or WebGL
// the picture stays.
#include "report/mesh_style.h"

namespace gonio::report {

const std::string_view solid_style = R"css(
.solid{width:100%}
.solid img,.solid canvas{display:block;width:100%;height:auto;aspect-ratio:4/3;background:#f0f0f0;border-radius:2px}
.solid canvas{cursor:grab;touch-action:none}
.solid canvas:active{cursor:grabbing}
.solid canvas:focus-visible{outline:2px solid var(--accent);outline-offset:2px}
.solid .controls{display:flex;flex-wrap:wrap;gap:.4rem .6rem;margin:.5rem 0;font-size:.8125rem;color:var(--soft)}
.solid .controls button{font:inherit;color:var(--ink);background:var(--fill);border:1px solid var(--line);
border-radius:3px;padding:.2rem .7rem;cursor:pointer}
.solid .controls button[aria-pressed=true]{border-color:var(--accent);box-shadow:inset 0 -2px var(--accent)}
.solid .controls label{display:inline-flex;align-items:center;gap:.3rem}
.solid .controls input[type=range]{flex:1;min-width:8rem;accent-color:var(--accent)}
.solid .controls select{font:inherit;color:var(--ink);background:var(--fill);border:1px solid var(--line);
border-radius:3px}
.solid .controls output{flex-basis:100%;font-variant-numeric:tabular-nums;color:var(--ink)}
.solid .stage{position:relative;overflow:hidden}
.solid .names span{position:absolute;left:0;top:0;padding:0 2px;font-size:.75rem;line-height:1.4;white-space:nowrap;
color:#1c1d1f;text-shadow:0 0 3px #fff,0 0 3px #fff,0 0 3px #fff;pointer-events:none}
.solid .keys{display:flex;flex-wrap:wrap;gap:.1rem 1.2rem;margin:.5rem 0;font-size:.8125rem;color:var(--soft)}
.solid .keys span{display:inline-flex;align-items:center;gap:.4rem}
.solid .keys i{width:.8rem;height:.8rem;border-radius:2px;border:1px solid var(--line);print-color-adjust:exact;
-webkit-print-color-adjust:exact}
svg .cursor{stroke:var(--accent);stroke-width:1.5;fill:none;pointer-events:none}
svg[data-time]{cursor:crosshair}
.solid .scale{margin:.4rem 0 0;max-width:none}
@media print{.solid .controls{display:none}}
)css";

const std::string_view solid_script = R"js(
for (const box of document.querySelectorAll('.solid')) {
  const d = box.dataset, picture = box.querySelector('img'), canvas = document.createElement('canvas');
  const gl = canvas.getContext('webgl', {preserveDrawingBuffer: true, antialias: true});
  if (!gl || !gl.getExtension('OES_element_index_uint')) continue;
  gl.getExtension('OES_standard_derivatives');
  const bytes = text => Uint8Array.from(atob(text || ''), c => c.charCodeAt(0));
  const numbers = text => text.split(' ').map(Number);
  const middle = numbers(d.middle), start = numbers(d.turn), reach = +d.side / +d.radius;
  const ramp = d.colours.split(',').map(c => [1, 3, 5].map(i => parseInt(c.slice(i, i + 2), 16) / 255));
  const part = (type, text) => {
    const s = gl.createShader(type);
    gl.shaderSource(s, text), gl.compileShader(s);
    return s;
  };
  const program = gl.createProgram();
  gl.attachShader(program, part(gl.VERTEX_SHADER, `attribute vec3 p; attribute vec3 c; uniform mat3 t; uniform vec3 m;
    uniform mat3 q; uniform vec3 o; uniform vec2 s, h; uniform float z; varying vec3 colour, at;
    void main() { at = t * (q * p + o - m); colour = c; gl_Position = vec4(at.xy * s + h, -at.z * z, 1.0); }`));
  gl.attachShader(program, part(gl.FRAGMENT_SHADER, `#extension GL_OES_standard_derivatives : enable
    precision highp float; varying vec3 colour, at;
    void main() { vec3 n = normalize(cross(dFdx(at), dFdy(at)));
      gl_FragColor = vec4(colour * (0.25 + 0.75 * abs(dot(n, vec3(-0.4, 0.45, 0.8)))), 1.0); }`));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) continue;
  gl.useProgram(program);
  const stored = (kind, data) => {
    const b = gl.createBuffer();
    gl.bindBuffer(kind, b), gl.bufferData(kind, data, gl.STATIC_DRAW);
    return b;
  };
  const meshes = [...box.querySelectorAll('script[data-name]')].map(s => {
    const raw = bytes(s.textContent), codes = new Uint16Array(raw.buffer), values = bytes(s.dataset.values);
    const positions = new Float32Array(codes.length), colours = new Float32Array(codes.length);
    for (let i = 0; i < codes.length; ++i) positions[i] = codes[i] / 65535;
    for (let v = 0; v < codes.length / 3; ++v) {
      let rgb = [0.72, 0.74, 0.76];
      if (values.length) {
        const x = values[v] / 255 * (ramp.length - 1), k = Math.min(ramp.length - 2, Math.floor(x));
        rgb = ramp[k].map((a, i) => a + (x - k) * (ramp[k + 1][i] - a));
      }
      colours.set(rgb, 3 * v);
    }
    const indices = new Uint32Array(bytes(s.dataset.indices).buffer);
    return {name: s.dataset.name, count: indices.length, positions: stored(gl.ARRAY_BUFFER, positions),
      colours: stored(gl.ARRAY_BUFFER, colours), indices: stored(gl.ELEMENT_ARRAY_BUFFER, indices)};
  });
  const model = typeof readModel === 'function' ? readModel(box, bytes) : null;
  for (const shape of model ? model.shapes : [])
    meshes.push({name: '', count: shape.indices.length, positions: stored(gl.ARRAY_BUFFER, shape.positions),
      indices: stored(gl.ELEMENT_ARRAY_BUFFER, shape.indices)});
  const stage = document.createElement('div');
  stage.className = 'stage';
  picture.replaceWith(stage);
  stage.append(canvas);
  const names = model && makeNames(stage, model);
  box.model = model;
  let timeline = null;
  canvas.tabIndex = 0;
  canvas.setAttribute('role', 'img');
  let turn = start.slice(), near = 1, shown = 0, shift = [0, 0];
  const known = {}, place = name => gl.getAttribLocation(program, name);
  const set = name => known[name] || (known[name] = gl.getUniformLocation(program, name));
  const draw = () => {
    const wide = canvas.clientWidth, ratio = window.devicePixelRatio || 1;
    if (!wide) return;
    canvas.width = Math.round(wide * ratio), canvas.height = Math.round(wide * 0.75 * ratio);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.94, 0.94, 0.94, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const t = turn, scale = [0.92 * 0.75 * reach * near, 0.92 * reach * near], time = timeline ? timeline.now() : 0;
    gl.uniformMatrix3fv(set('t'), false, [t[0], t[3], t[6], t[1], t[4], t[7], t[2], t[5], t[8]]);
    gl.uniform3fv(set('m'), middle);
    gl.uniform2fv(set('s'), scale);
    gl.uniform2fv(set('h'), shift);
    gl.uniform1f(set('z'), model ? 0.1 * reach : 0.4);
    let bound = null;
    const show = (mesh, q, o, colour) => {
      for (const [name, buffer] of mesh === bound ? [] : [['p', mesh.positions], ['c', mesh.colours]]) {
        if (!buffer) continue;
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.enableVertexAttribArray(place(name));
        gl.vertexAttribPointer(place(name), 3, gl.FLOAT, false, 0, 0);
      }
      if (colour) gl.vertexAttrib3fv(place('c'), colour);
      gl.uniformMatrix3fv(set('q'), false, [q[0], q[3], q[6], q[1], q[4], q[7], q[2], q[5], q[8]]);
      gl.uniform3fv(set('o'), o);
      if (mesh !== bound) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.indices);
      gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
      bound = mesh;
    };
    if (model) {
      for (const n of model.place(time)) if (n.shape >= 0) show(meshes[n.shape], n.q, n.o, model.colourAt(n, time));
      const high = wide * 0.75;
      names.put(o => {
        const at = applied(t, o.map((v, i) => v - middle[i]));
        return [wide / 2 * (1 + at[0] * scale[0] + shift[0]), high / 2 * (1 - at[1] * scale[1] - shift[1])];
      }, wide, high);
    } else if (meshes.length) show(meshes[shown], [1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 0, 0], null);
    const name = model ? 'model' : meshes.length ? meshes[shown].name : '';
    canvas.setAttribute('aria-label', d.name + (model ? '' : ': ' + name));
    box.dataset.drawn = name;
  };
  const rotate = (across, up) => {
    const c = Math.cos(across), s = Math.sin(across), e = Math.cos(up), f = Math.sin(up), t = turn;
    const r = [0, 1, 2].map(k => [c * t[k] + s * t[6 + k], t[3 + k], c * t[6 + k] - s * t[k]]);
    turn = [0, 0, 0, 0, 0, 0, 0, 0, 0];
    for (let k = 0; k < 3; ++k)
      turn[k] = r[k][0], turn[3 + k] = e * r[k][1] - f * r[k][2], turn[6 + k] = f * r[k][1] + e * r[k][2];
    draw();
  };
  const zoom = factor => { near = Math.min(20, Math.max(0.5, near * factor)); draw(); };
  canvas.addEventListener('pointerdown', e => canvas.setPointerCapture(e.pointerId));
  canvas.addEventListener('pointermove', e => {
    if (!(e.buttons & 3)) return;
    if (e.shiftKey || e.buttons & 2) {
      shift[0] += 2 * e.movementX / canvas.clientWidth, shift[1] -= 2 * e.movementY / canvas.clientHeight;
      draw();
    } else rotate(e.movementX * 0.008, e.movementY * 0.008);
  });
  canvas.addEventListener('contextmenu', e => e.preventDefault());
  canvas.addEventListener('wheel', e => { e.preventDefault(); zoom(Math.exp(-0.0015 * e.deltaY)); }, {passive: false});
  canvas.addEventListener('keydown', e => {
    const by = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]}[e.key];
    if (by) rotate(by[0], by[1]);
    else if (e.key === '+') zoom(1.2);
    else if (e.key === '-') zoom(1 / 1.2);
    else if (e.key === 'Home') { turn = start.slice(), near = 1, shift = [0, 0]; draw(); }
    else return;
    e.preventDefault();
  });
  const controls = document.createElement('div'), buttons = [];
  controls.className = 'controls';
  if (model && model.end > 0) timeline = makeTimeline(box, model, draw, controls);
  if (model && names.count) {
    const label = document.createElement('label'), tick = document.createElement('input');
    Object.assign(tick, {type: 'checkbox', checked: true});
    tick.addEventListener('change', () => { names.all.hidden = !tick.checked; });
    label.append(tick, 'names');
    controls.append(label);
  }
  if (controls.children.length || meshes.length > 1) stage.after(controls);
  if (!model && meshes.length > 1) {
    meshes.forEach((mesh, i) => {
      const b = document.createElement('button');
      b.type = 'button', b.textContent = mesh.name, b.setAttribute('aria-pressed', i === 0);
      b.addEventListener('click', () => {
        shown = i;
        buttons.forEach((o, k) => o.setAttribute('aria-pressed', k === i));
        draw();
      });
      buttons.push(controls.appendChild(b));
    });
  }
  new ResizeObserver(draw).observe(canvas);
  if (timeline) timeline.seek(timeline.now());
  else draw();
}
)js";

}  // namespace gonio::report
