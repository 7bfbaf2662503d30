// The report's style sheet and script. Light and dark follow the reader's system; nothing is fetched.
#pragma once

namespace experiments {

/// Line and bar colours are told apart with usual colour blindness (Okabe and Ito, "Color Universal Design", 2008).
inline constexpr const char* kReportStyle = R"css(
:root { color-scheme: light dark; --ground: #fff; --ink: #1c1e21; --faint: #6a7078; --rule: #d5d9de; --panel: #f4f5f7;
  --best: #d9f0dd; --s0: #1c1e21; --s1: #0072b2; --s2: #d55e00; --s3: #009e73; --s4: #b8578f; --s5: #c68a00; --s6:
  #3f9fd6;
  --s7: #8a8f00; }
@media (prefers-color-scheme: dark) { :root { --ground: #17191c; --ink: #e4e6e9; --faint: #9aa1aa; --rule: #3a3f45;
  --panel: #212429; --best: #1f4a2b; --s0: #e4e6e9; --s1: #4aa3e0; --s2: #f08040; --s3: #2fc596; --s4: #d987b8; --s5:
  #e6ab2e;
  --s6: #8accf2; --s7: #ccd03a; } }
body { background: var(--ground); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; margin: 0 auto; max-width:
  1180px;
  padding: 24px; }
h1 { font-size: 1.8em; margin: 0 0 .2em; } h2 { font-size: 1.35em; margin: 2em 0 .5em; } h3 { font-size: 1.08em;
  margin: 1.4em 0 .4em; }
.faint { color: var(--faint); } .scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .4em 0 1em; }
th, td { border-bottom: 1px solid var(--rule); padding: 5px 12px; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; } td small { color: var(--faint); display: block; font-size:
  .82em; }
td.best { background: var(--best); font-weight: 600; } td.best small { font-weight: 400; }
dt { font-weight: 600; } dd { margin: 0 0 .4em 1.2em; }
details { margin: .6em 0; } summary { cursor: pointer; }
svg { max-width: 100%; height: auto; } svg text { fill: var(--ink); font-size: 13px; } svg text.heading { font-size:
  15px; font-weight: 600; }
svg .grid { stroke: var(--rule); } svg .axis { stroke: var(--faint); }
.line path { fill: none; stroke: var(--c); stroke-width: 2; stroke-dasharray: var(--dash); } .line circle { fill:
  var(--c); }
.line path.whisker { opacity: .5; stroke-dasharray: none; stroke-width: 1.5; }
rect.bar { fill: var(--c); }
.s0, .s8 { --c: var(--s0); } .s1, .s9 { --c: var(--s1); } .s2, .s10 { --c: var(--s2); } .s3, .s11 { --c: var(--s3); }
.s4, .s12 { --c: var(--s4); } .s5, .s13 { --c: var(--s5); } .s6, .s14 { --c: var(--s6); } .s7, .s15 { --c: var(--s7);
  }
.s8, .s9, .s10, .s11, .s12, .s13, .s14, .s15 { --dash: 6 3; } rect.s8, rect.s9, rect.s10, rect.s11, rect.s12,
  rect.s13, rect.s14,
rect.s15 { opacity: .55; }
.legend span { display: inline-flex; align-items: center; gap: 6px; margin-right: 18px; } .key { flex: none; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 500px), 1fr)); gap: 12px; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 340px), 1fr)); gap: 12px; }
figure { margin: 0 0 1.6em; } .panel { background: var(--panel); padding: 6px; } .panel img { cursor: zoom-in;
  display: block; width: 100%; }
.panel p { margin: 4px 2px 0; font-size: .92em; }
#zoom { background: #000d; border: 0; color: #fff; height: 100%; margin: 0; max-height: none; max-width: none;
  padding: 0; width: 100%; }
#zoom img { display: block; height: calc(100% - 48px); image-rendering: pixelated; margin: auto; max-width: 100%;
  object-fit: contain; }
#zoom p { margin: 8px; text-align: center; }
)css";

/// A click enlarges a panel; the arrow keys then go through the figure's panels in place, for flip comparison.
inline constexpr const char* kReportScript = R"js(
const zoom = document.getElementById('zoom'), large = zoom.querySelector('img'), label = zoom.querySelector('p');
let images = [], at = 0;
function show(i) {
  at = (i + images.length) % images.length;
  large.src = images[at].src; large.alt = images[at].alt;
  label.textContent = images[at].alt + ' (' + (at + 1) + ' of ' + images.length + '; arrow keys change, Escape closes)';
}
for (const figure of document.querySelectorAll('figure')) {
  const own = [...figure.querySelectorAll('.panel img')];
  own.forEach((image, i) => image.addEventListener('click', () => { images = own; show(i); zoom.showModal(); }));
}
zoom.addEventListener('click', () => zoom.close());
zoom.addEventListener('keydown', e => {
  if (e.key === 'ArrowRight') show(at + 1);
  if (e.key === 'ArrowLeft') show(at - 1);
});
)js";

}  // namespace experiments
