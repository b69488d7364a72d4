#include <fmt/format.h>

#include "live/live_view.h"
#include "report/chart.h"
#include "report/page.h"

namespace hqslam::tools {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --page: #ffffff; --text: #1c1f24; --quiet: #666d78;
  --panel: #f6f7f9; --path: #d4432c; }
@media (prefers-color-scheme: dark) {
  :root { --page: #14171b; --text: #e4e7eb; --quiet: #99a1ad; --panel: #1c2026; --path: #ff7a5c; } }
html, body { margin: 0; height: 100%; background: var(--page); color: var(--text);
  font: 15px/1.4 system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif; }
body { display: flex; flex-direction: column; }
header { display: flex; flex-wrap: wrap; gap: .3rem 1.6rem; align-items: baseline;
  padding: .6rem 1rem; background: var(--panel); font-variant-numeric: tabular-nums; }
h1 { font-size: 1rem; margin: 0; font-weight: 650; }
dl { display: flex; flex-wrap: wrap; gap: .2rem 1.4rem; margin: 0; }
dl div { display: flex; gap: .4rem; }
dt { color: var(--quiet); }
dd { margin: 0; font-weight: 600; }
#gone { color: var(--path); font-weight: 600; }
canvas { flex: 1; min-height: 0; width: 100%; touch-action: none; cursor: grab; }
button { font: inherit; padding: 0 .7rem; }
)css";

// State: points and positions in centimetres, a position with its segment of the path, between
// which no way is known; the view is a centre and a scale (pixels a metre),
// which follow what is there until somebody drags or zooms. Points are drawn once, on a canvas
// behind the scenes, and all again only when the view changes.
constexpr const char* kScript = R"js(
'use strict';
const canvas = document.getElementById('map'), context = canvas.getContext('2d');
const cloud = document.createElement('canvas'), cloudContext = cloud.getContext('2d');
let generation = 0, points = [], positions = [], last = null;
let drawn = 0, centre = [0, 0], scale = 8, free = false;

const show = (id, text) => { document.getElementById(id).textContent = text; };
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const toX = x => (x - centre[0]) * scale + canvas.width / 2;
const toY = y => canvas.height / 2 - (y - centre[1]) * scale;

// Heights from blue to yellow, by where most points are.
let low = -2, high = 4;
function colour(z) {
  const t = Math.max(0, Math.min(1, (z - low) / (high - low)));
  return `hsl(${235 - 185 * t} 75% ${45 + 10 * t}%)`;
}
function setHeights() {
  const heights = [];
  for (let i = 2; i < points.length; i += 3 * Math.ceil(points.length / 6000)) heights.push(points[i]);
  if (heights.length < 20) return;
  heights.sort((a, b) => a - b);
  low = heights[Math.floor(.02 * heights.length)] / 100;
  high = Math.max(low + 1, heights[Math.floor(.95 * heights.length)] / 100);
}

function fit() {
  if (free) return;
  let [x0, x1, y0, y1] = [-10, 10, -10, 10];
  for (const list of [positions, points]) {
    const step = list === points ? 3 * Math.max(1, Math.ceil(list.length / 30000)) : 4;
    for (let i = 0; i + 2 < list.length; i += step) {
      x0 = Math.min(x0, list[i] / 100); x1 = Math.max(x1, list[i] / 100);
      y0 = Math.min(y0, list[i + 1] / 100); y1 = Math.max(y1, list[i + 1] / 100);
    }
  }
  const wanted = .95 * Math.min(canvas.width / (x1 - x0), canvas.height / (y1 - y0));
  // Not at every scan a little: only when something is outside or much room is left.
  const inside = toX(x0) >= 0 && toX(x1) <= canvas.width && toY(y1) >= 0 && toY(y0) <= canvas.height;
  if (inside && wanted < 1.3 * scale) return;
  scale = .92 * wanted; centre = [(x0 + x1) / 2, (y0 + y1) / 2]; drawn = 0;
}

function draw() {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio].map(Math.round);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width; canvas.height = height; drawn = 0;
  }
  fit();
  if (drawn === 0) { cloud.width = width; cloud.height = height; setHeights(); }
  const size = Math.max(1, Math.min(3, scale * .12));
  for (; drawn + 2 < points.length; drawn += 3) {
    cloudContext.fillStyle = colour(points[drawn + 2] / 100);
    cloudContext.fillRect(toX(points[drawn] / 100), toY(points[drawn + 1] / 100), size, size);
  }
  context.clearRect(0, 0, width, height);
  context.drawImage(cloud, 0, 0);
  context.strokeStyle = context.fillStyle = css('--path');
  context.lineWidth = 2 * ratio;
  context.beginPath();
  let segment = -1;
  const goTo = (x, y, on) => {
    if (on === segment) context.lineTo(x, y); else context.moveTo(x, y);
    segment = on;
  };
  for (let i = 0; i + 3 < positions.length; i += 4) {
    goTo(toX(positions[i] / 100), toY(positions[i + 1] / 100), positions[i + 3]);
  }
  if (last) {
    const [x, y] = [toX(last.position_m[0]), toY(last.position_m[1])];
    goTo(x, y, last.segment);
    context.stroke();
    const a = last.heading_rad, r = 8 * ratio;  // an arrow where the sensor is
    context.beginPath();
    for (const [turn, length] of [[0, 1.6], [2.5, 1], [Math.PI, .4], [-2.5, 1]]) {
      context.lineTo(x + r * length * Math.cos(a + turn), y - r * length * Math.sin(a + turn));
    }
    context.fill();
  }
  drawScale(ratio);
}

function drawScale(ratio) {
  const metres = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find(m => m * scale > 60 * ratio) || 2000;
  const y = canvas.height - 18 * ratio, x = 16 * ratio;
  context.fillStyle = css('--text');
  context.fillRect(x, y, metres * scale, 2 * ratio);
  context.font = `${12 * ratio}px sans-serif`;
  context.fillText(`${metres} m`, x, y - 5 * ratio);
}

async function ask() {
  try {
    const answer = await fetch(`/state?generation=${generation}&positions=${positions.length / 4}` +
                               `&points=${points.length / 3}`);
    const state = await answer.json();
    if (state.generation !== generation) {
      generation = state.generation; points = []; positions = []; drawn = 0;
    }
    for (const v of state.points) points.push(v);
    for (const v of state.positions) positions.push(v);
    last = state;
    show('position', state.position_m.map(v => v.toFixed(2)).join('  ') + ' m');
    show('path', state.path_m.toFixed(1) + ' m');
    show('rate', state.rate_hz.toFixed(1) + ' scans/s');
    show('latency', state.latency_ms.toFixed(0) + ' ms');
    show('lost', `${state.lost_packets} packets, ${state.dropped_scans} scans`);
    show('mapping', state.mapping);
    show('gone', state.warning);
    draw();
    setTimeout(ask, state.points.length >= 60000 ? 0 : 500);
  } catch (error) {
    show('gone', 'hqslam does not answer any more');
    setTimeout(ask, 2000);
  }
}

let grabbed = null;
canvas.onpointerdown = e => { grabbed = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); };
canvas.onpointerup = () => { grabbed = null; };
canvas.onpointermove = e => {
  if (!grabbed) return;
  const ratio = window.devicePixelRatio || 1;
  centre = [centre[0] - (e.clientX - grabbed[0]) * ratio / scale,
            centre[1] + (e.clientY - grabbed[1]) * ratio / scale];
  grabbed = [e.clientX, e.clientY]; free = true; drawn = 0; draw();
};
canvas.onwheel = e => {
  e.preventDefault(); free = true; drawn = 0;
  scale *= Math.exp(-e.deltaY / 600); draw();
};
document.getElementById('all').onclick = () => { free = false; scale = 1e-6; drawn = 0; draw(); };
window.onresize = draw;
ask();
)js";

// The scan's controls go: there is one scan, the last.
constexpr const char* kTurningStyle = R"css(
body { max-width: none; padding-top: 0; }
.turning-view .stage { aspect-ratio: auto; height: calc(100vh - 9rem); min-height: 15rem; }
.turning-view .controls:has(.play) { display: none; }
)css";

constexpr const char* kTurningScript = R"js(
<p class="quiet"><a href="/">From above, with numbers</a> <span id="gone"></span></p>
<script>
const view = document.querySelector('.turning-view'), gone = document.getElementById('gone');
async function ask() {
  try {
    view.renew(await (await fetch('/turning/data')).json());
    gone.textContent = '';
  } catch (error) { gone.textContent = 'hqslam does not answer any more'; }
  setTimeout(ask, 2000);
}
if (view.renew) { view.querySelector('[data-view=behind]').click(); ask(); }
</script>
)js";

}  // namespace

std::string live_page(const std::string& title) {
  const std::string escaped = escape_html(title);
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>{1}</style>\n</head>\n"
      "<body>\n<header><h1>{0}</h1><dl>\n"
      "<div><dt>position</dt><dd id=\"position\">-</dd></div>\n"
      "<div><dt>path</dt><dd id=\"path\">-</dd></div>\n"
      "<div><dt>rate</dt><dd id=\"rate\">-</dd></div>\n"
      "<div><dt>latency</dt><dd id=\"latency\">-</dd></div>\n"
      "<div><dt>lost</dt><dd id=\"lost\">-</dd></div>\n"
      "<div><dt>mapping</dt><dd id=\"mapping\">-</dd></div>\n"
      "</dl><button id=\"all\">show all</button><a href=\"/turning\">turn it</a><span "
      "id=\"gone\"></span></header>\n"
      "<canvas id=\"map\"></canvas>\n<script>{2}</script>\n</body>\n</html>\n",
      escaped, kStyle, kScript);
}

std::string live_turning_page(const std::string& title, const TurningView& view) {
  Page page(title);
  page.style(kTurningViewStyle);
  page.style(kTurningStyle);
  page.html(turning_view_html(view));
  page.html(kTurningScript);
  return page.text();
}

}  // namespace hqslam::tools
