'use strict';
// Tables that sort by a click, or Enter, on a column's name.

/**
 * A table of {title, columns, rows, links}: cells are text, the first of a row names it; links, if
 * there are any, has a page for each row's name. text: numbers of columns that hold words.
 */
function table(data, {text = []} = {}) {
  const rows = data.rows.map((cells, i) => ({cells, link: (data.links || [])[i]}));
  const body = el('tbody');
  const isText = i => i === 0 || text.includes(i);
  function show() {
    body.replaceChildren(...rows.map(
        ({cells, link}) =>
            el('tr', {},
               ...cells.map(
                   (cell, i) =>
                       el('td', {class: isText(i) ? 'text' : undefined},
                          i === 0 && link          ? el('a', {href: link}, cell) :
                              cell instanceof Node ? cell :
                                                     String(cell))))));
  }
  let sorted = -1, rising = false;
  function sortBy(column) {
    rising = sorted === column ? !rising : true;
    sorted = column;
    const key = row => {  // of "0.25 [0.2, 0.3]" the first number; words as they are
      const cell = row.cells[column], number = parseFloat(cell instanceof Node ? cell.textContent : cell);
      return Number.isNaN(number) ? String(cell) : number;
    };
    const order = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === 'number' ? -1 : 1;
    rows.sort((a, b) => (rising ? 1 : -1) * order(key(a), key(b)));
    show();
  }
  const head = el('tr', {}, ...data.columns.map((name, i) => el('th', {
    class: isText(i) ? 'text' : undefined, title: 'Sort by this column', tabindex: 0,
    onclick: () => sortBy(i), onkeydown: event => event.key === 'Enter' && sortBy(i)}, name)));
  show();
  return el(
      'div', {}, data.title ? el('h3', {}, data.title) : null,
      el('div', {class: 'scroll'}, el('table', {}, el('thead', {}, head), body)));
}
