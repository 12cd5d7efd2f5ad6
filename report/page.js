// The report page: its data, what the three parts share, and the start. Loaded last.
// SPDX-License-Identifier: BSD-3-Clause
'use strict';

const report = JSON.parse(document.getElementById('report').textContent);
const frames = [...new Set(report.rows.map((row) => row.frame))];
const kMeanLabel = 'mean over frames';
/// What results are measured against. Only a suite has ray-traced truth.
const kReferenceName = report.kind === 'compare' ? 'reference' : 'truth';

/// Columns that the page knows: heading, hint, decimals where they are fixed, and whether the sign is always shown. The order is the table's.
const kColumns = {
  ms: { heading: 'ms', hint: 'compute time on the device in milliseconds' },
  ms_min: { heading: 'ms min', hint: 'compute time of the fastest run' },
  ms_max: { heading: 'ms max', hint: 'compute time of the slowest run' },
  yardsticks: { heading: 'yardsticks', hint: 'compute time over that of the yardstick kernel in the same minute' },
  rmse: { heading: 'RMSE', hint: 'root of the mean squared error over non-sky pixels', decimals: 4 },
  mae: { heading: 'MAE', hint: 'mean absolute error', decimals: 4 },
  bias: { heading: 'bias', hint: 'mean error: below zero is too dark', signed: true, decimals: 4 },
  p95: { heading: 'p95', hint: '95 of 100 pixels have an absolute error below', decimals: 4 },
  p99: { heading: 'p99', hint: '99 of 100 pixels have an absolute error below', decimals: 4 },
  max: { heading: 'max', hint: 'largest absolute error', decimals: 4 },
  ssim: { heading: 'SSIM', hint: 'structural similarity; 1: the same', decimals: 4 },
  flip: { heading: 'FLIP', hint: 'mean perceived difference, 0 to 1', decimals: 4 },
  grain: { heading: 'grain', hint: 'stripes and specks on plain surfaces: RMS of the error less its mean over 15 x 15 pixels', decimals: 4 },
  mottle: { heading: 'mottle', hint: 'clouds on smooth surfaces in half shadow: RMS of the standard deviation between three seeds', decimals: 4 },
  psnr: { heading: 'PSNR', hint: 'peak signal to noise ratio in dB' },
  estimator_rmse: { heading: 'estimator RMSE', hint: 'error against an exact search of the same depth buffer: what sampling costs', decimals: 4 },
  geometry_rmse: { heading: 'geometry RMSE', hint: 'error of that exact search against the truth: what a depth buffer cannot see', decimals: 4 },
  holes: { heading: 'holes', hint: 'pixels that are NaN or infinite in one of the two files only' },
  flicker: { heading: 'flicker', hint: 'RMS of the change of the error on a surface from a frame to the next', decimals: 4 },
  samples_per_pixel: { heading: 'samples/px', hint: 'depth samples a pixel' },
};

/// An element with attributes and children; strings become text, never markup.
function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/// Fills a <select> with [value, label] pairs and keeps what was chosen where it is still there.
function fill_select(select, options) {
  const before = select.value;
  select.replaceChildren(...options.map(([value, label]) => make('option', { value }, label)));
  if (options.some(([value]) => value === before)) select.value = before;
}

/// The decimals that give the smallest of `values` so many digits.
function decimals_of_least(values, digits) {
  const sizes = values.map(Math.abs).filter((size) => size > 0);
  return sizes.length ? Math.max(0, digits - 1 - Math.floor(Math.log10(Math.min(...sizes)))) : 0;
}

/// The decimals of a column: those that it has where it is known, and more where they would hide a small number.
function decimals_for(values, known) {
  if (known !== undefined) return Math.min(12, Math.max(known, decimals_of_least(values, 2)));
  return values.every(Number.isInteger) ? 0 : Math.min(4, decimals_of_least(values, 3));
}

function format(value, decimals, signed = false) {
  if (!Number.isFinite(value)) return '–';
  const text = Math.abs(value).toFixed(decimals);
  const zero = Number(text) === 0;
  return (value < 0 && !zero ? '−' : signed && !zero ? '+' : '') + text;
}

/// A candidate or row with its time in yardsticks, where there is a yardstick: its frame's own, or for means the report's.
function with_yardsticks(row) {
  const yardstick_ms = report.frames?.find((frame) => frame.name === row.frame)?.yardstick_ms ?? report.yardstick_ms;
  return yardstick_ms > 0 && Number.isFinite(row.ms) ? { ...row, yardsticks: row.ms / yardstick_ms } : row;
}

/// A single number of the column `key`.
function number_text(key, value) {
  return format(value, decimals_for([value], kColumns[key]?.decimals), kColumns[key]?.signed);
}

/// [heading, value as text] of every number in `row`, in the table's order, unknown ones last.
function numbers_of(row) {
  const keys = [...new Set([...Object.keys(kColumns), ...Object.keys(row)])].filter((key) => Number.isFinite(row[key]));
  return keys.map((key) => [kColumns[key]?.heading ?? key, number_text(key, row[key])]);
}

/// [name, text] of what is known of a sequence as a whole.
function sequence_facts({ worst_frame, worst_rmse, mean_rmse, flicker }) {
  const facts = [['Worst frame', `${worst_frame}, RMSE ${number_text('rmse', worst_rmse)}`], ['Mean RMSE', number_text('rmse', mean_rmse)]];
  const flickers = Number.isFinite(flicker) ? number_text('flicker', flicker) : 'not measured: no two frames follow each other';
  return flicker === undefined ? facts : [...facts, ['Flicker', flickers]];
}

function start_header() {
  document.title = `${report.title} – Alcove`;
  document.getElementById('title').textContent = report.title;
  document.getElementById('kind').textContent = `Alcove ${report.kind}`;
  const facts = [['Device', report.device], ['Yardstick', report.yardstick_ms && `${number_text('ms', report.yardstick_ms)} ms`],
    ['Frames', frames.length], [report.kind === 'wedge' ? 'Looks' : 'Candidates', report.candidates.length]];
  if (report.candidates.length === 1) facts[3] = [report.kind === 'compare' ? 'Compared' : 'Settings', report.candidates[0].settings];
  if (report.sequence) facts.push(...sequence_facts(report.sequence));
  for (const [name, value] of facts) {
    if (value) document.getElementById('facts').append(make('div', {}, make('dt', {}, name), make('dd', {}, String(value))));
  }
}

/// PASS or FAIL, each limit with the value that comes nearest to it, and the frames that could not be compared.
function start_verdict() {
  if (!report.verdict) return;
  const { pass, limits, failed } = report.verdict;
  const verdict = document.getElementById('verdict');
  verdict.hidden = false;
  document.getElementById('limits').hidden = limits.length === 0;
  verdict.textContent = pass ? 'PASS' : 'FAIL';
  verdict.className = pass ? 'pass' : 'fail';
  const exact = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(6))) : '–');
  const rows = limits.map(({ option, limit, value, frame, holds }) => make('tr', { class: holds ? 'pass' : 'fail' }, make('th', { scope: 'row' }, holds ? option : `${option} ✗`),
    make('td', { class: 'number' }, exact(limit)), make('td', { class: 'number' }, exact(value)), make('td', {}, frame)));
  document.querySelector('#limits tbody').replaceChildren(...rows);
  const errors = (failed ?? []).map(({ frame, error }) => make('li', {}, `frame ${frame} was not compared: ${error}`));
  document.getElementById('failed').hidden = errors.length === 0;
  document.getElementById('failed').replaceChildren(...errors);
}

start_header();
start_verdict();
start_chart();
start_table();
start_looks();
start_viewer();
