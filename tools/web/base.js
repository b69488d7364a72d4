'use strict';
// What every page needs: its data, and short ways to make elements.
//
// The program writes a page's data as JSON into <script id="data">. Long series of numbers and
// images stand there as {"f32": "base64"} and the like: the bytes of a typed array.

/** The data of this page. */
function pageData() {
  const text = document.getElementById('data').textContent.trim();
  return text ? JSON.parse(text) : {};
}

/** The bytes that base64 text stands for. */
const bytesOf = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0));

/**
 * Numbers as an array: a list as it is (null becomes NaN), or a block of bytes. A block with "step"
 * holds whole numbers n that stand for low + n * step.
 */
function numbersOf(block) {
  if (!block) return [];
  if (ArrayBuffer.isView(block)) return block;
  if (Array.isArray(block)) return block.map(value => value === null ? NaN : value);
  const kinds = {f32: Float32Array, u32: Uint32Array, u16: Uint16Array, i16: Int16Array, u8: Uint8Array};
  const kind = Object.keys(kinds).find(name => name in block);
  const values = new kinds[kind](bytesOf(block[kind]).buffer);
  return block.step === undefined ? values : Float32Array.from(values, n => (block.low || 0) + n * block.step);
}

/**
 * An element: el('p', {class: 'quiet', onclick: f}, 'text', otherElement, ...). Text stays text: it
 * is never read as markup.
 */
function el(tag, attributes = {}, ...children) {
  const svg = ['svg', 'g', 'path', 'line', 'text', 'circle', 'rect', 'image', 'title'].includes(tag);
  const element = svg ? document.createElementNS('http://www.w3.org/2000/svg', tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element[name] = value;
    else if (value !== undefined && value !== null && value !== false)
      element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.filter(child => child !== null && child !== undefined));
  return element;
}

/** The element with this id. */
const at = id => document.getElementById(id);

/** Puts elements into the element with this id, instead of what is there. */
const fill = (id, ...children) =>
    at(id).replaceChildren(...children.filter(child => child !== null && child !== undefined));

/** Shows the part of the page with this id only if there is something to show. */
const showIf = (id, isThere) => {
  at(id).hidden = !isThere;
  return isThere;
};

const clamp = (value, least, most) => Math.max(least, Math.min(most, value));
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
/** The colour of the i-th of several things. */
const colourOf = i => `var(--c${i % 8})`;

/** The colour at a share of the way through a list of "#rrggbb". */
function colourBetween(stops, share) {
  const place = clamp(Number.isFinite(share) ? share : 0, 0, 1) * (stops.length - 1),
        i = Math.min(Math.floor(place), stops.length - 2);
  const part = (hex, k) => parseInt(hex.slice(1 + 2 * k, 3 + 2 * k), 16);
  return [0, 1, 2].map(k => Math.round(part(stops[i], k) + (place - i) * (part(stops[i + 1], k) - part(stops[i], k))));
}

/** "0.042", "3.78", "31.7", "6717": three digits that count. */
function short(value) {
  if (value === undefined || value === null || !Number.isFinite(value)) return '-';
  if (value === 0) return '0';
  const size = Math.abs(value);
  return size >= 1000 ? value.toFixed(0) : size < 1e-3 ? value.toExponential(1) : String(Number(value.toPrecision(3)));
}
/** With so many decimals; no zero has a sign. */
const fixed = (value, decimals) => Number.isFinite(value) ? value.toFixed(decimals).replace(/^-(?=[0.]*$)/, '') : '-';

/** Headline numbers, each {label, value, unit, note}. */
function numbers(list) {
  return el(
      'dl', {class: 'numbers'},
      ...list.filter(Boolean).map(
          n =>
              el('div', {}, el('dt', {}, n.label),
                 el('dd', {}, String(n.value), n.unit ? el('small', {}, ' ' + n.unit) : null),
                 n.note ? el('dd', {class: 'note'}, n.note) : null)));
}

/** What colours mean: [[colour, text], ...]. */
function legend(entries) {
  return el(
      'ul', {class: 'legend'},
      ...entries.map(([colour, text]) => el('li', {}, el('i', {style: `background:${colour}`}), text)));
}

/** A row of buttons of which one is chosen; choose(i) is called for each click. */
function choice(names, choose, first = 0) {
  const buttons = names.map((name, i) => el('button', {onclick: () => take(i)}, name));
  function take(i, quietly) {
    buttons.forEach((button, k) => button.classList.toggle('chosen', k === i));
    if (!quietly) choose(i);
  }
  take(first, true);
  return el('span', {class: 'controls'}, ...buttons);
}

/** What stands below the first figure of a page until a pointer is over it; below others nothing. */
let isHintGiven = false;
function hint(text) {
  if (isHintGiven) return '';
  isHintGiven = true;
  return text || 'The values under the pointer or finger are shown here.';
}

/** Lets the keyboard reach an element, and calls act(right, down), each 1, 0 or -1, for its arrow keys. */
function onArrowKeys(element, act) {
  element.tabIndex = 0;
  element.onkeydown = event => {
    const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    if (!step) return;
    event.preventDefault();
    act(...step);
  };
}

/** Median and other quantiles of numbers; NaN of none. */
function quantile(values, share) {
  const sorted = Float64Array.from(values).filter(Number.isFinite).sort();
  if (!sorted.length) return NaN;
  const place = share * (sorted.length - 1), below = Math.floor(place);
  return sorted[below] + (place - below) * ((sorted[below + 1] ?? sorted[below]) - sorted[below]);
}

/** The page's title, heading, line below it, notices, and which program made it. */
function pageHead(data, kind) {
  document.title = `hqslam ${kind}: ${data.title}`;
  document.body.prepend(...[el('h1', {}, data.title), data.subtitle ? el('p', {class: 'quiet'}, data.subtitle) : null,
                            ...(data.notices || []).map(text => el('p', {class: 'notice'}, text))]
                            .filter(Boolean));
  document.body.append(
      el('footer', {}, data.command_line ? el('p', {}, el('code', {}, data.command_line)) : '',
         `Made by hqslam ${data.version}${data.date ? ` on ${data.date}` : ''}. This page needs no other file and no network.`));
}
