// The picture viewer: two pictures under a divider that noUiSlider moves, zoom and pan, and what lies under the pointer.
// SPDX-License-Identifier: BSD-3-Clause
'use strict';

const kTruth = ' truth';  // The value of the choice of the truth, or of the reference, on the right; a candidate's name has no leading space.
const kMaxZoom = 16;
const kStageWidth = 640;  // Smaller pictures are enlarged to at least this width, by a whole number.

/// What is shown: the picture's size, its scale in CSS pixels a picture pixel and the place of its corner in the stage.
const view = { width: 1, height: 1, scale: 1, x: 0, y: 0, fitted: true };

const by_id = (id) => document.getElementById(id);
const picture_of = (frame, candidate) => report.images.find((image) => image.frame === frame && image.candidate === candidate);
const truth_of = (frame) => report.images.find((image) => image.frame === frame && image.truth)?.truth;
const showing = () => document.querySelector('#viewer-show input:checked').value;
const showing_error = () => showing() === 'error';
/// The picture of an image that is chosen: its result, composite or error. A plain beauty has one picture.
const shown_of = (image) => image?.[showing()] ?? image?.beauty;

/// Only pictures that are inside the page are shown.
function set_picture(layer, url, text) {
  const image = layer.querySelector('img');
  layer.hidden = !url?.startsWith('data:image/');
  image.alt = text;
  if (layer.hidden) image.removeAttribute('src');
  else image.src = url;
}

function fit_scale() {
  return by_id('stage').clientWidth / view.width;
}

/// Draws the view: never smaller than fitted (or 1, if that is smaller), never with a gap where the picture could be.
function draw_view() {
  const stage = by_id('stage');
  const fit = fit_scale();
  view.scale = view.fitted ? fit : Math.min(kMaxZoom, Math.max(Math.min(fit, 1), view.scale));
  const place = (at, room, size) => (size <= room ? (room - size) / 2 : Math.min(0, Math.max(room - size, at)));
  view.x = place(view.x, stage.clientWidth, view.width * view.scale);
  view.y = place(view.y, stage.clientHeight, view.height * view.scale);
  for (const image of stage.querySelectorAll('img')) {
    image.style.transform = `translate(${view.x}px, ${view.y}px) scale(${view.scale})`;
    image.style.imageRendering = view.scale >= 2 ? 'pixelated' : 'auto';
  }
  stage.classList.toggle('zoomed', view.scale > fit * 1.001);
  show_pixel();
  for (const button of document.querySelectorAll('#viewer-zoom [data-zoom]')) {
    const zoom = button.dataset.zoom;
    if (zoom === 'fit' || Number(zoom)) button.setAttribute('aria-pressed', zoom === 'fit' ? view.fitted : !view.fitted && view.scale === Number(zoom));
  }
}

/// Sets the scale and keeps the picture's point under (x, y) of the stage where it is.
function zoom_to(scale, x = by_id('stage').clientWidth / 2, y = by_id('stage').clientHeight / 2) {
  scale = Math.min(kMaxZoom, Math.max(Math.min(fit_scale(), 1), scale));
  view.x = x - (x - view.x) * (scale / view.scale);
  view.y = y - (y - view.y) * (scale / view.scale);
  view.scale = scale;
  view.fitted = false;
  draw_view();
}

function zoom_fit() {
  view.fitted = true;
  draw_view();
}

/// Zooms by `factor`; reaching the fitted size on the way out means "fit".
function zoom_by(factor, x, y) {
  if (factor < 1 && view.scale * factor <= fit_scale()) zoom_fit();
  else zoom_to(view.scale * factor, x, y);
}

function pan_by(dx, dy) {
  view.x += dx;
  view.y += dy;
  draw_view();
}

const probe = Object.assign(document.createElement('canvas'), { width: 1, height: 1 }).getContext('2d', { willReadFrequently: true });
const depth_image = new Image();
let pointer = null;  // the last event of the pointer on the stage

/// The bytes r, g, b of a pixel; nothing where the picture is not there.
function bytes_of(image, x, y) {
  if (!image.complete || !image.naturalWidth) return null;
  probe.drawImage(image, x, y, 1, 1, 0, 0, 1, 1);
  return probe.getImageData(0, 0, 1, 1).data;
}

/// A picture's value under the pointer: a grey one in parts of 1, a colour in bytes.
function value_text(side, x, y) {
  const bytes = !by_id(`layer-${side}`).hidden && bytes_of(document.querySelector(`#layer-${side} img`), x, y);
  if (!bytes) return [];
  const [r, g, b] = bytes;
  return [`${by_id(`chip-${side}`).textContent}: ${showing() === 'result' && r === g && g === b ? (r / 255).toFixed(2) : `${r} ${g} ${b}`}`];
}

/// The planar depth of a pixel in scene units; nothing for sky.
function depth_at({ near, far }, x, y) {
  const step = bytes_of(depth_image, x, y)?.[0];
  return step ? near * (far / near) ** ((step - 1) / 254) : null;
}

/// Shows the values under the pointer, and around it the radius of the look that lies there.
function show_pixel() {
  const box = by_id('stage').getBoundingClientRect(), ring = by_id('ring');
  const at = pointer && { x: pointer.clientX - box.left, y: pointer.clientY - box.top };
  const [x, y] = at ? [Math.floor((at.x - view.x) / view.scale), Math.floor((at.y - view.y) / view.scale)] : [-1, -1];
  const texts = [];
  ring.hidden = true;
  if (x >= 0 && y >= 0 && x < view.width && y < view.height && !showing_error()) {
    texts.push(`${x}, ${y}`, ...value_text('left', x, y), ...value_text('right', x, y));
    const scale = report.frames?.find((frame) => frame.name === by_id('viewer-frame').value)?.scale;
    const depth = scale && depth_at(scale, x, y);
    const side = at.x < box.width * parseFloat(by_id('stage').style.getPropertyValue('--divider')) / 100 ? 'left' : 'right';
    const radius = report.candidates.find((look) => look.name === by_id(`viewer-${side}`).value)?.radius;
    if (depth) texts.push(`depth ${depth.toPrecision(3)}`);
    if (depth && radius) {
      const [width, height] = scale.tangents.map((tangent) => radius / tangent / (scale.orthographic ? 1 : depth) * view.scale);
      Object.assign(ring.style, { left: `${at.x - width}px`, top: `${at.y - height}px`, width: `${2 * width}px`, height: `${2 * height}px` });
      ring.hidden = false;
      texts.push(`circle: radius ${radius}`);
    }
  }
  by_id('pixel').textContent = texts.join(' · ');
}

/// Shows what the boxes above the pictures say.
function fill_viewer() {
  const frame = by_id('viewer-frame').value;
  const left = picture_of(frame, by_id('viewer-left').value);
  const right = picture_of(frame, by_id('viewer-right').value);
  const error = showing_error();
  const right_name = right ? right.candidate : kReferenceName;
  set_picture(by_id('layer-left'), shown_of(left), `${left.candidate}${error ? ', signed error' : ''}`);
  set_picture(by_id('layer-right'), right || error ? shown_of(right) : truth_of(frame), `${right_name}${error ? ', signed error' : ''}`);
  const divided = !by_id('layer-right').hidden;
  by_id('stage').classList.toggle('divided', divided);
  by_id('chip-left').textContent = error ? `${left.candidate}: result − ${kReferenceName}` : left.candidate;
  by_id('chip-right').textContent = error ? `${right_name}: result − ${kReferenceName}` : right_name;
  by_id('legend').hidden = !error;
  const full = String(Number((left.full ?? 0.25).toPrecision(3)));
  by_id('legend-least').textContent = `−${full}`;
  by_id('legend-most').textContent = `+${full}`;
  const row = report.rows.find((each) => each.frame === frame && each.candidate === left.candidate);
  by_id('viewer-numbers').textContent = row && report.kind !== 'wedge' ? `${left.candidate}: ${numbers_of(with_yardsticks(row)).map(([heading, text]) => `${heading} ${text}`).join(' · ')}` : '';

  if (left.width !== view.width || left.height !== view.height) Object.assign(view, { width: left.width, height: left.height, fitted: true });
  const stage = by_id('stage');
  stage.style.setProperty('--width', `${left.width * Math.max(1, Math.ceil(kStageWidth / left.width))}px`);
  stage.style.setProperty('--ratio', left.width / left.height);
  for (const image of stage.querySelectorAll('img')) Object.assign(image, { width: left.width, height: left.height });
  draw_view();
  fill_looks();
}

/// The candidates that have pictures of the chosen frame.
function fill_choices() {
  const names = report.images.filter((image) => image.frame === by_id('viewer-frame').value).map((image) => [image.candidate, image.candidate]);
  const truth = truth_of(by_id('viewer-frame').value);
  fill_select(by_id('viewer-left'), names);
  fill_select(by_id('viewer-right'), truth ? [[kTruth, kReferenceName], ...names] : [...names.slice(1), names[0]]);
  depth_image.src = report.frames?.find((each) => each.name === by_id('viewer-frame').value)?.scale?.depth ?? 'data:,';
  for (const side of ['left', 'right']) by_id(`viewer-${side}`).parentElement.hidden = names.length < 2;
  fill_viewer();
}

function start_divider() {
  const slider = noUiSlider.create(by_id('divider'), {
    start: 50, range: { min: 0, max: 100 }, behaviour: 'snap', animate: false, keyboardDefaultStep: 50,
    handleAttributes: [{ 'aria-label': 'Divider between the left and the right picture' }],
    ariaFormat: { to: (value) => `${Math.round(value)} %`, from: Number },
  });
  slider.on('update', (values, handle, numbers) => by_id('stage').style.setProperty('--divider', `${numbers[0]}%`));
}

/// Shows the whole left picture, or the whole right one.
function flip() {
  const slider = by_id('divider').noUiSlider;
  slider.set(Number(slider.get()) > 50 ? 0 : 100);
}

/// Dragging pans; the divider's handle lies above and keeps its own drags.
function start_pan(stage) {
  let from = null;
  stage.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !stage.classList.contains('zoomed') || event.target.closest('.noUi-handle')) return;
    from = { x: event.clientX, y: event.clientY };
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener('pointermove', (event) => {
    if (!from) return;
    pan_by(event.clientX - from.x, event.clientY - from.y);
    from = { x: event.clientX, y: event.clientY };
  });
  for (const end of ['pointerup', 'pointercancel']) stage.addEventListener(end, () => { from = null; });
}

function start_zoom(stage) {
  by_id('viewer-zoom').addEventListener('click', (event) => {
    const zoom = event.target.dataset.zoom;
    if (zoom === 'fit') zoom_fit();
    else if (zoom === 'in' || zoom === 'out') zoom_by(zoom === 'in' ? 2 : 0.5);
    else if (zoom) zoom_to(Number(zoom));
  });
  stage.addEventListener('wheel', (event) => {
    if (event.deltaY > 0 && view.fitted) return;  // Nothing left to zoom out of: the page scrolls.
    event.preventDefault();
    const box = stage.getBoundingClientRect();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1;
    zoom_by(2 ** (-event.deltaY * lines / 240), event.clientX - box.left, event.clientY - box.top);
  }, { passive: false });
  stage.addEventListener('keydown', (event) => {
    if (event.target !== stage || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = { f: flip, '+': () => zoom_by(2), '=': () => zoom_by(2), '-': () => zoom_by(0.5), 0: zoom_fit,
      ArrowLeft: () => pan_by(60, 0), ArrowRight: () => pan_by(-60, 0), ArrowUp: () => pan_by(0, 60), ArrowDown: () => pan_by(0, -60) }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}

/// The frames from the largest error to the least.
function by_error(names) {
  const rmse = (name) => report.rows.find((row) => row.frame === name)?.rmse ?? -1;
  return [...names].sort((a, b) => rmse(b) - rmse(a));
}

/// Offers the frames that have pictures, and gives them as they are in the report.
function fill_frames() {
  const shown = [...new Set(report.images.map((image) => image.frame))];
  const sorted = by_id('viewer-sort').querySelector('input').checked ? by_error(shown) : shown;
  fill_select(by_id('viewer-frame'), sorted.map((frame) => [frame, frame]));
  return shown;
}

function start_viewer() {
  if (!report.images.length) return;
  by_id('viewer-section').hidden = false;
  for (const input of document.querySelectorAll('#viewer-show input')) input.parentElement.hidden = !report.images.some((image) => image[input.value]);
  by_id('viewer-show').hidden = !report.images.some((image) => image.error || image.composite);
  const stage = by_id('stage');
  const shown = fill_frames();
  by_id('viewer-frame').parentElement.hidden = shown.length < 2;
  if (report.kind === 'compare') {
    by_id('viewer-sort').hidden = shown.length < 2;
    by_id('viewer-frame').value = by_error(shown)[0];
    if (picture_of(by_error(shown)[0], report.candidates[0].name).error) document.querySelector('#viewer-show input[value=error]').checked = true;
  }
  by_id('viewer-sort').addEventListener('change', fill_frames);
  start_divider();
  start_pan(stage);
  start_zoom(stage);
  fill_choices();
  by_id('viewer-frame').addEventListener('change', fill_choices);
  by_id('flip').addEventListener('click', flip);
  stage.addEventListener('pointermove', (event) => { pointer = event; show_pixel(); });
  stage.addEventListener('pointerleave', () => { pointer = null; show_pixel(); });
  depth_image.addEventListener('load', show_pixel);
  for (const id of ['viewer-left', 'viewer-right', 'viewer-show']) by_id(id).addEventListener('change', fill_viewer);
  new ResizeObserver(draw_view).observe(stage);
}
