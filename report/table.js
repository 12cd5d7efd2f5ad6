// The table of measurements: one row a frame and candidate, or a candidate's means, sorted by any column.
// SPDX-License-Identifier: BSD-3-Clause
'use strict';

const kMeanFrame = ' mean';  // The value of the choice "mean over frames"; a frame's name has no leading space.
const table_state = { sort: null, descending: false };

/// {key, heading, hint, signed, text, decimals}: the columns in which any row has something to show.
function table_columns() {
  const rows = [...report.rows, ...report.candidates].map(with_yardsticks);
  const known = [...Object.keys(kColumns)];
  const unknown = [...new Set(rows.flatMap(Object.keys))].filter((key) => !known.includes(key));
  const numeric = [...known, ...unknown].map((key) => ({ key, values: rows.map((row) => row[key]).filter(Number.isFinite) }))
    .filter(({ values }) => values.length)
    .map(({ key, values }) => ({ key, heading: key, ...kColumns[key], decimals: decimals_for(values, kColumns[key]?.decimals) }));
  return [{ key: 'frame', heading: 'frame', text: true }, { key: 'candidate', heading: 'candidate', text: true }, ...numeric];
}

function table_rows(frame) {
  const rows = frame === kMeanFrame ? report.candidates.map((candidate) => ({ ...candidate, frame: 'mean', candidate: candidate.name }))
    : report.rows.filter((row) => frame === '' || row.frame === frame);
  return rows.map(with_yardsticks);
}

/// Order of two values: text as people count (2 before 10); what is missing comes last in either direction.
function compare_values(a, b, text, descending) {
  const missing = (value) => !(text ? typeof value === 'string' : Number.isFinite(value));
  if (missing(a) || missing(b)) return missing(a) - missing(b);
  const order = text ? a.localeCompare(b, undefined, { numeric: true }) : a - b;
  return descending ? -order : order;
}

function fill_table(columns) {
  const rows = table_rows(document.getElementById('table-frame').value);
  const sort = columns.find((column) => column.key === table_state.sort);
  if (sort) rows.sort((a, b) => compare_values(a[sort.key], b[sort.key], sort.text, table_state.descending));
  const settings = new Map(report.candidates.map((candidate) => [candidate.name, candidate.settings]));
  const cell = (row, column) => {
    if (!column.text) return make('td', { class: 'number' }, format(row[column.key], column.decimals, column.signed));
    return column.key === 'candidate' ? make('th', { scope: 'row', title: settings.get(row.candidate) ?? '' }, row.candidate) : make('td', {}, column.key === 'frame' && row.fails ? `${row.frame} ✗` : row[column.key]);
  };
  document.querySelector('#table tbody').replaceChildren(...rows.map((row) => make('tr', row.fails ? { class: 'fail', title: 'breaks a limit' } : {}, ...columns.map((column) => cell(row, column)))));
  for (const heading of document.querySelectorAll('#table thead th')) {
    heading.setAttribute('aria-sort', heading.dataset.key !== table_state.sort ? 'none' : table_state.descending ? 'descending' : 'ascending');
  }
}

function start_table() {
  const select = document.getElementById('table-frame');
  fill_select(select, [['', 'all frames'], [kMeanFrame, kMeanLabel], ...frames.map((frame) => [frame, frame])]);
  select.parentElement.hidden = frames.length < 2;
  const columns = table_columns();
  for (const column of columns) {
    const button = make('button', { type: 'button', title: column.hint ?? '' }, column.heading);
    button.addEventListener('click', () => {
      table_state.descending = table_state.sort === column.key && !table_state.descending;
      table_state.sort = column.key;
      fill_table(columns);
    });
    document.querySelector('#table thead tr').append(make('th', { scope: 'col', class: column.text ? '' : 'number', 'data-key': column.key }, button));
  }
  select.addEventListener('change', () => fill_table(columns));
  fill_table(columns);
}
