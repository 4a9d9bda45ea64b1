// Style: one column of text 46 rem wide, figures up to 70 rem; numbers in tabular figures; one accent; no decoration
// that carries no meaning. Series colours are those of Okabe & Ito (2008), darkened on white and lightened on black to
// a contrast of 3:1; good is their blue and bad their vermilion, which colour-blind readers tell apart. Script: moves
// the dividers of the pairs; without it each divider stands in the middle and everything else works.
#include "report/page_style.h"

namespace gonio::report {

const std::string_view page_style = R"css(
:root{color-scheme:light dark;--paper:#fdfdfc;--ink:#1c1d1f;--soft:#62666d;--line:#e2e2de;--fill:#f4f4f1;--accent:#1f5fa8;
--good:#0067a5;--bad:#b34700;--s0:#0067a5;--s1:#c55a00;--s2:#00805e;--s3:#a3457e;--s4:#8a6d00;--s5:#4a4f57}
@media (prefers-color-scheme:dark){:root{--paper:#16181b;--ink:#e7e7e4;--soft:#9da2aa;--line:#32363c;--fill:#1f2226;
--accent:#7db4f0;--good:#63b3ec;--bad:#f0a052;--s0:#63b3ec;--s1:#f0a052;--s2:#3fc7a0;--s3:#e095c3;--s4:#dbc04d;--s5:#b9bec6}}
*{box-sizing:border-box}
html{scroll-behavior:smooth;-webkit-text-size-adjust:100%}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",
"Liberation Sans",sans-serif;font-variant-numeric:tabular-nums}
main,header,footer{max-width:72rem;margin:0 auto;padding:0 1.5rem}
header{padding-top:3.25rem}
.eyebrow{margin:0 0 .75rem;font-size:.8125rem;letter-spacing:.08em;text-transform:uppercase;color:var(--soft)}
h1{margin:0 0 .9rem;max-width:54rem;font-size:clamp(1.5rem,1.1rem + 1.6vw,2.125rem);line-height:1.22;font-weight:620;
letter-spacing:-.012em;text-wrap:balance;overflow-wrap:anywhere}
h1.good{border-left:4px solid var(--good);padding-left:1rem}
h1.bad{border-left:4px solid var(--bad);padding-left:1rem}
.lead{max-width:46rem;margin:0 0 1.5rem;color:var(--soft);font-size:1.0625rem}
nav{position:sticky;top:0;z-index:5;background:var(--paper);border-bottom:1px solid var(--line)}
nav div{max-width:72rem;margin:0 auto;padding:.6rem 1.5rem;display:flex;gap:.25rem 1.4rem;overflow-x:auto;
scrollbar-width:thin;font-size:.875rem}
nav a{color:var(--soft);text-decoration:none;white-space:nowrap}
nav a:hover,nav a:focus-visible{color:var(--accent)}
section{padding:2.1rem 0 .4rem;scroll-margin-top:2rem}
section+section{border-top:1px solid var(--line)}
h2{margin:0 0 .8rem;font-size:1.3125rem;line-height:1.3;font-weight:620;letter-spacing:-.005em}
h3{margin:1.8rem 0 .5rem;font-size:1rem;font-weight:620}
p,ul{max-width:46rem;margin:0 0 1rem}
li{margin:.2rem 0}
.note{font-size:.875rem;color:var(--soft)}
dl.numbers{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(10.5rem,40%),1fr));gap:1.1rem 1.75rem;margin:1.1rem 0 1.7rem}
dl.numbers div{border-top:2px solid var(--line);padding-top:.5rem;min-width:0}
dl.numbers .good{border-color:var(--good)}
dl.numbers .bad{border-color:var(--bad)}
dl.numbers dt{font-size:.8125rem;color:var(--soft)}
dl.numbers dd{margin:0;font-size:1.5rem;line-height:1.35;font-weight:560;letter-spacing:-.01em;overflow-wrap:anywhere}
dl.numbers dd.bad{color:var(--bad)}
dl.numbers dd.good{color:var(--good)}
dl.numbers dd small{font-size:.875rem;font-weight:400;color:var(--soft);letter-spacing:0}
dl.numbers dd.under{font-size:.8125rem;font-weight:400;color:var(--soft);line-height:1.4;letter-spacing:0}
.scroll{overflow-x:auto;margin:1rem 0 1.5rem;scrollbar-width:thin}
table{border-collapse:collapse;font-size:.9063rem;min-width:min(100%,26rem)}
caption{caption-side:top;text-align:left;padding:0 0 .5rem;color:var(--soft);font-size:.875rem}
th,td{padding:.4rem 1.6rem .4rem 0;text-align:left;vertical-align:baseline;border-bottom:1px solid var(--line)}
th{font-weight:560;font-size:.8125rem;color:var(--soft);border-bottom-color:var(--soft);white-space:nowrap}
th small{font-weight:400;font-size:inherit}
.n{text-align:right;white-space:nowrap}
tr>:last-child{padding-right:0}
table:has(th:nth-child(8)) td:first-child{white-space:nowrap}
.figures{display:flex;flex-wrap:wrap;gap:1.5rem 2rem;margin:1rem 0 1.5rem}
figure{margin:0;min-width:0;max-width:100%}
figure img,figure>svg{display:block;max-width:100%;height:auto}
figure img{image-rendering:pixelated;border-radius:2px}
figcaption{margin-top:.5rem;font-size:.875rem;line-height:1.45;color:var(--soft);max-width:46rem}
.figures figcaption{max-width:none}
figcaption b{display:block;color:var(--ink);font-weight:560}
.pair{margin:1rem 0 1.5rem}
.pair-frame{position:relative;display:grid;max-width:100%;overflow:hidden;border-radius:2px;--cut:50%}
.pair-frame img{grid-area:1/1;width:100%;border-radius:0}
.pair-frame img.over{clip-path:inset(0 0 0 var(--cut))}
.pair-frame input{grid-area:1/1;appearance:none;-webkit-appearance:none;width:100%;height:100%;margin:0;opacity:0;cursor:ew-resize;
touch-action:pan-y;z-index:2}
.pair-frame input::-webkit-slider-thumb{-webkit-appearance:none;width:1px;height:100%}
.pair-frame .divider{position:absolute;top:0;bottom:0;left:var(--cut);width:2px;margin-left:-1px;background:#fff;
box-shadow:0 0 0 1px rgba(0,0,0,.4);pointer-events:none}
.pair-frame .divider::after{content:"\2194";position:absolute;top:50%;left:50%;width:2.1rem;height:2.1rem;margin:-1.05rem;
border-radius:50%;background:#fff;color:#222;display:grid;place-items:center;font:1rem/1 system-ui,sans-serif;
box-shadow:0 0 0 1px rgba(0,0,0,.35),0 1px 4px rgba(0,0,0,.3)}
.pair-frame input:focus-visible~.divider::after{outline:3px solid var(--accent);outline-offset:1px}
.pair-frame .tag{position:absolute;top:.6rem;padding:.1rem .5rem;border-radius:2px;background:rgba(20,20,20,.72);color:#fff;
font-size:.75rem;pointer-events:none}
.pair-frame .tag.left{left:.6rem}
.pair-frame .tag.right{right:.6rem}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,26rem),1fr));gap:1.5rem 2.5rem;margin:1rem 0 1.5rem}
.plot{max-width:44rem;width:100%;margin-bottom:1.25rem}
.plot svg{width:100%;height:auto;overflow:visible}
.plot .title{margin:0 0 .3rem;font-weight:560;font-size:.9375rem}
.legend{display:flex;flex-wrap:wrap;gap:.1rem 1.2rem;margin:0 0 .3rem;font-size:.8125rem;color:var(--soft)}
.legend span{display:inline-flex;align-items:center;gap:.4rem}
.legend svg{width:1.6rem;height:.8rem;overflow:visible}
svg text{font:12px system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans","Liberation Sans",sans-serif;fill:var(--soft);
font-variant-numeric:tabular-nums}
svg .axis{stroke:var(--soft);stroke-width:1;fill:none}
svg .grid{stroke:var(--line);stroke-width:1;fill:none}
svg .mark{stroke:var(--ink);stroke-width:1;stroke-dasharray:2 3;fill:none}
svg .mark-name{fill:var(--ink)}
svg .line{fill:none;stroke-width:1.75;stroke-linejoin:round;stroke-linecap:round}
svg .error{stroke-width:1.25;fill:none}
svg .band{opacity:.18;stroke:none}
svg .bars{opacity:.75;stroke:none}
svg .c0{stroke:var(--s0);fill:var(--s0)}svg .c1{stroke:var(--s1);fill:var(--s1)}svg .c2{stroke:var(--s2);fill:var(--s2)}
svg .c3{stroke:var(--s3);fill:var(--s3)}svg .c4{stroke:var(--s4);fill:var(--s4)}svg .c5{stroke:var(--s5);fill:var(--s5)}
svg .line,svg .error{fill:none}
svg .bars,svg .band{stroke:none}
svg .shade{fill:var(--accent);opacity:.1;stroke:none}
dl.scores{display:grid;grid-template-columns:minmax(8rem,max-content) 1fr;gap:.45rem 1rem;margin:1rem 0 1.4rem;max-width:46rem;
font-size:.9063rem}
dl.scores dt{color:var(--soft)}
dl.scores dd{margin:0;display:grid;grid-template-columns:var(--share) max-content;align-items:center;gap:.6rem}
dl.scores dd i{display:block;height:.85rem;min-width:2px;border-radius:2px;background:var(--s5);print-color-adjust:exact;
-webkit-print-color-adjust:exact}
dl.scores dd.good i{background:var(--good)}
dl.scores dd.bad i{background:var(--bad)}
figure:has(.heat){margin:0 0 1.4rem}
.heat td{padding:.32rem .55rem;min-width:3.2rem;text-align:right;border:1px solid var(--paper);color:#111}
.heat td.pale{color:#fff}
.heat th{padding-right:1rem;border:0}
.heat thead th{padding:.3rem .55rem;text-align:right;white-space:normal;vertical-align:bottom}
.scale{max-width:24rem;margin:.25rem 0 1.5rem;font-size:.8125rem;color:var(--soft)}
.scale .ramp{height:.7rem;border-radius:2px;margin:.3rem 0 .15rem;print-color-adjust:exact;-webkit-print-color-adjust:exact}
.scale .ticks{display:flex;justify-content:space-between}
details{margin:0;border-top:1px solid var(--line);padding:.7rem 0}
details[open]{padding-bottom:1.2rem}
section>details:last-of-type{border-bottom:1px solid var(--line);margin-bottom:1.5rem}
.verdict{margin:0 0 1rem;font-weight:560}
summary{cursor:pointer;color:var(--accent);font-size:.9375rem}
footer{margin-top:2.5rem;padding-top:1rem;padding-bottom:2.5rem;border-top:1px solid var(--line);font-size:.8125rem;color:var(--soft)}
@media (max-width:40rem){dl.scores{grid-template-columns:1fr;gap:.1rem}dl.scores dd{margin-bottom:.5rem}main,header,footer{padding-left:1rem;padding-right:1rem}nav div{padding-left:1rem;padding-right:1rem}
header{padding-top:1.75rem}}
@media (prefers-reduced-motion:reduce){html{scroll-behavior:auto}}
@media print{:root{color-scheme:light;--paper:#fff;--ink:#000;--soft:#444;--line:#ccc;--fill:#f4f4f4;--accent:#000;--good:#0067a5;
--bad:#b34700;--s0:#0067a5;--s1:#c55a00;--s2:#00805e;--s3:#a3457e;--s4:#8a6d00;--s5:#4a4f57}
body{font-size:10.5pt}nav{display:none}figure,table,dl.numbers div{break-inside:avoid}h2,h3{break-after:avoid}header{padding-top:0}
.heat td{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
)css";

const std::string_view page_script = R"js(
'use strict';
for (const frame of document.querySelectorAll('.pair-frame')) {
  const range = frame.querySelector('input');
  const move = () => {
    const share = range.value / range.max;
    frame.style.setProperty('--cut', (100 * share) + '%');
    range.setAttribute('aria-valuetext', Math.round(100 * share) + ' % ' + frame.dataset.left);
  };
  range.addEventListener('input', move);
  move();
}
addEventListener('beforeprint', () => document.querySelectorAll('details').forEach(d => { d.open = true; }));
document.documentElement.dataset.ready = document.querySelectorAll('.pair-frame').length + ' pairs';
)js";

}  // namespace gonio::report
