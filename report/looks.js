// The looks of a wedge: a small picture of each, its time, and the command that makes it.
// SPDX-License-Identifier: BSD-3-Clause
'use strict';

/// Selects an element's text and copies it: unlike the clipboard's own interface, this works in a page of every kind of address.
function copy_text(element, button) {
  getSelection().selectAllChildren(element);
  button.textContent = document.execCommand('copy') ? 'copied' : 'press Ctrl+C';
  setTimeout(() => { button.textContent = 'copy'; }, 1500);
}

/// A button that puts a look on a side of the viewer.
function side_button(name, side) {
  const select = by_id(`viewer-${side}`);
  const button = make('button', { type: 'button', 'aria-pressed': select.value === name }, side);
  button.addEventListener('click', () => { select.value = name; fill_viewer(); });
  return button;
}

function look_card(look) {
  const image = picture_of(by_id('viewer-frame').value, look.name);
  const row = report.rows.find((each) => each.frame === image?.frame && each.candidate === look.name);
  // Lines break between the words of a command, and not behind hyphens.
  const command = make('code', {}, ...look.settings.split(' ').flatMap((word) => [' ', make('span', {}, word)]).slice(1));
  const copy = make('button', { type: 'button', 'aria-label': `copy the command of ${look.name}` }, 'copy');
  copy.addEventListener('click', () => copy_text(command, copy));
  const choice = (label, ...buttons) => make('div', { class: 'choice', role: 'group', 'aria-label': `${label} of ${look.name}` }, ...buttons);
  const sides = image ? [choice('side', side_button(look.name, 'left'), side_button(look.name, 'right'))] : [];
  const card = make('figure', { class: 'look' },
    make('figcaption', {}, make('strong', {}, look.name), make('span', {}, row ? `${number_text('ms', row.ms)} ms` : 'failed')),
    make('div', { class: 'actions' }, ...sides, choice('command', copy)), command);
  if (image) card.prepend(make('img', { alt: '', src: shown_of(image), width: image.width, height: image.height, loading: 'lazy' }));
  for (const note of look.notes) card.append(make('p', {}, note));
  return card;
}

/// Called by the viewer, whose choices the cards show. The button that was pressed keeps the focus.
function fill_looks() {
  if (report.kind !== 'wedge') return;
  const buttons = () => [...document.querySelectorAll('#looks button')];
  const pressed = buttons().indexOf(document.activeElement);
  by_id('looks').replaceChildren(...report.candidates.map(look_card));
  buttons()[pressed]?.focus({ preventScroll: true });
}

function start_looks() {
  by_id('looks-section').hidden = report.kind !== 'wedge';
  by_id('table-section').hidden = report.kind === 'wedge';
  if (report.kind === 'wedge') document.querySelector('#viewer-show span').textContent = 'AO';
}
