// The chart of error against time, with the Pareto front. Chart.js draws it; the box that names a point is HTML, so that it can be read and styled.
// SPDX-License-Identifier: BSD-3-Clause
'use strict';

/// The candidates that have a time and an error, over all frames ('') or in one, as {x, y, row}, fastest first. `unit`: 'ms' or 'yardsticks'.
function chart_points(frame, unit) {
  const settings = new Map(report.candidates.map((candidate) => [candidate.name, candidate.settings]));
  const rows = frame === '' ? report.candidates
    : report.rows.filter((row) => row.frame === frame).map((row) => ({ ...row, name: row.candidate, settings: settings.get(row.candidate) }));
  return rows.map(with_yardsticks).filter((row) => row[unit] > 0 && Number.isFinite(row.rmse))
    .map((row) => ({ x: row[unit], y: row.rmse, row })).sort((a, b) => a.x - b.x || a.y - b.y);
}

/// Of points sorted by time those that are better than every faster one.
function pareto_front(points) {
  let best = Infinity;
  return points.filter((point) => point.y < best && ((best = point.y), true));
}

/// The box beside the point that is hovered or chosen by the arrow keys.
function show_tip({ chart, tooltip }) {
  const tip = document.getElementById('tip');
  const point = tooltip.opacity > 0 && tooltip.dataPoints?.[0]?.raw;
  tip.hidden = !point;
  if (!point) return;
  const numbers = numbers_of(point.row).map(([heading, text]) => make('div', {}, make('dt', {}, heading), make('dd', {}, text)));
  tip.replaceChildren(make('strong', {}, point.row.name), make('code', {}, point.row.settings ?? ''), make('dl', {}, ...numbers));
  // Right of the point, else left, else above or below it: the point itself stays visible.
  const gap = 14;
  const [right, left] = [tooltip.caretX + gap, tooltip.caretX - gap - tip.offsetWidth];
  const [above, below] = [tooltip.caretY - gap - tip.offsetHeight, tooltip.caretY + gap];
  const beside = right + tip.offsetWidth <= chart.width || left >= 0;
  const clamp = (at, room) => Math.max(0, Math.min(room, at));
  tip.style.left = `${clamp(right + tip.offsetWidth <= chart.width || !beside ? right : left, chart.width - tip.offsetWidth)}px`;
  tip.style.top = beside ? `${clamp(tooltip.caretY - tip.offsetHeight / 2, chart.height - tip.offsetHeight)}px` : `${above >= 0 ? above : below}px`;
}

/// Also hides the box, whose place would be wrong when the points move.
function choose_no_point(chart) {
  chart.setActiveElements([]);
  chart.tooltip?.setActiveElements([], { x: 0, y: 0 });
  document.getElementById('tip').hidden = true;
}

/// Labels of a logarithmic axis: round values only, within one decade all, else those at 1, 2 and 5.
function log_label(value, index, ticks) {
  const digit = Number((value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toPrecision(6));
  const wide = ticks[ticks.length - 1].value / ticks[0].value > 10;
  const shown = wide ? [1, 2, 5].includes(digit) : Number.isInteger(digit * 2);
  return shown ? String(Number(value.toPrecision(3))) : '';
}

const kLabelLength = 32;  // Characters of a name beside its point.

/// Names the points where there is room: those on the front first, each beside the line, which comes from above and goes to the right.
const name_points = {
  id: 'name_points',
  afterDatasetsDraw(chart) {
    const { ctx, chartArea: area } = chart;
    const points = [1, 2].flatMap((set) => chart.getDatasetMeta(set).data.map((point, index) => ({ x: point.x, y: point.y, name: chart.data.datasets[set].data[index].row.name })));
    const taken = points.map(({ x, y }) => ({ left: x - 7, right: x + 7, top: y - 7, bottom: y + 7 }));
    const is_free = (box) => box.left >= area.left && box.right <= area.right && box.top >= area.top && box.bottom <= area.bottom
      && taken.every((other) => box.right <= other.left || box.left >= other.right || box.bottom <= other.top || box.top >= other.bottom);
    chart.named = [];
    ctx.save();
    ctx.font = `12px ${Chart.defaults.font.family}`;
    ctx.fillStyle = getComputedStyle(document.body).color;
    ctx.textBaseline = 'middle';
    for (const { x, y, name } of points) {
      const text = name.length > kLabelLength ? `${name.slice(0, kLabelLength - 1)}…` : name;
      const width = ctx.measureText(text).width;
      const places = [[x + 7, y + 13], [x - 11 - width, y], [x - 7 - width, y + 13], [x + 7, y - 13], [x - 7 - width, y - 13], [x + 11, y]];
      const boxes = places.map(([left, middle]) => ({ left, right: left + width, top: middle - 7, bottom: middle + 7 }));
      const box = boxes.find(is_free);
      if (!box) continue;
      taken.push(box);
      chart.named.push(name);
      ctx.fillText(text, box.left, (box.top + box.bottom) / 2);
    }
    ctx.restore();
  },
};

function chart_options() {
  const axis = (text) => ({ title: { display: true, text }, border: {}, grid: {}, ticks: {} });
  return {
    animation: false,
    maintainAspectRatio: false,
    onResize: choose_no_point,
    interaction: { mode: 'nearest', intersect: true },
    plugins: { legend: { display: false }, tooltip: { enabled: false, external: show_tip, filter: (item) => item.raw.row !== undefined } },
    scales: {
      x: { type: 'logarithmic', ...axis(''), ticks: { callback: log_label, maxRotation: 0 } },
      y: { type: 'linear', ...axis('RMSE against the truth (lower is better)'), grace: '10%' },
    },
  };
}

/// Colours come from the style sheet, so that there is one place for both schemes.
function colour_chart(chart) {
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const [line, front, others] = chart.data.datasets;
  line.borderColor = front.borderColor = front.backgroundColor = front.hoverBackgroundColor = colour('--accent');
  others.borderColor = others.hoverBorderColor = colour('--muted');
  others.backgroundColor = others.hoverBackgroundColor = colour('--card');
  for (const scale of Object.values(chart.options.scales)) {
    scale.grid.color = scale.grid.borderColor = colour('--line');
    scale.ticks.color = colour('--muted');
    scale.title.color = colour('--text');
  }
}

function fill_chart(chart) {
  const unit = document.querySelector('#chart-unit input:checked').value;
  const frame = document.getElementById('chart-frame').value;
  const points = chart_points(frame, unit);
  const front = pareto_front(points);
  const [line, on_front, others] = chart.data.datasets;
  line.data = front.map(({ x, y }) => ({ x, y }));
  on_front.data = front;
  others.data = points.filter((point) => !front.includes(point));
  document.getElementById('key-others').hidden = !others.data.length;
  const x = chart.options.scales.x;
  x.title.text = `compute time in ${unit} (logarithmic)`;
  x.min = points.length ? points[0].x / 1.3 : undefined;
  x.max = points.length ? points[points.length - 1].x * 1.3 : undefined;
  chart.canvas.setAttribute('aria-label', `Error against time of ${points.length} candidates, ${front.length} on the Pareto front. Arrow keys go from point to point.`);
  const item = ({ row }) => {
    const times = ['ms', 'yardsticks'].filter((key) => key in row).map((key) => `${number_text(key, row[key])} ${kColumns[key].heading}`);
    return make('li', {}, make('strong', {}, row.name), ' ', make('span', {}, [...times, `RMSE ${number_text('rmse', row.rmse)}`].join(' · ')),
      make('code', {}, row.settings ?? ''));
  };
  document.getElementById('front').replaceChildren(...front.map(item));
  choose_no_point(chart);
  chart.update();
}

/// Left and right go through the points by time.
function step_point(chart, step) {
  const all = [1, 2].flatMap((datasetIndex) => chart.data.datasets[datasetIndex].data.map((point, index) => ({ datasetIndex, index, point })))
    .sort((a, b) => a.point.x - b.point.x || a.point.y - b.point.y);
  if (!all.length) return;
  const active = chart.getActiveElements()[0];
  const now = all.findIndex((entry) => active && entry.datasetIndex === active.datasetIndex && entry.index === active.index);
  const next = all[now < 0 ? (step > 0 ? 0 : all.length - 1) : Math.max(0, Math.min(all.length - 1, now + step))];
  const { x, y } = chart.getDatasetMeta(next.datasetIndex).data[next.index];
  chart.setActiveElements([next]);
  chart.tooltip.setActiveElements([next], { x, y });
  chart.update();
}

function start_chart() {
  if (!chart_points('', 'ms').length) return;
  document.getElementById('chart-section').hidden = false;
  const select = document.getElementById('chart-frame');
  fill_select(select, [['', kMeanLabel], ...frames.map((frame) => [frame, frame])]);
  select.parentElement.hidden = frames.length < 2;
  document.getElementById('chart-unit').hidden = !report.yardstick_ms;

  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.font.size = 13;
  const point = { pointRadius: 6, pointHoverRadius: 8, pointHitRadius: 6, borderWidth: 2, pointBorderWidth: 2 };
  const chart = new Chart(document.getElementById('chart'), {
    type: 'scatter',
    data: {
      datasets: [
        { label: 'front line', data: [], showLine: true, stepped: 'before', pointRadius: 0, pointHitRadius: 0, pointHoverRadius: 0, borderWidth: 2, order: 3 },
        { label: 'on the front', data: [], ...point, order: 1 },
        { label: 'others', data: [], ...point, order: 2 },
      ],
    },
    options: chart_options(),
    plugins: [name_points],
  });
  colour_chart(chart);
  fill_chart(chart);

  for (const control of [select, document.getElementById('chart-unit')]) control.addEventListener('change', () => fill_chart(chart));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { colour_chart(chart); chart.update(); });
  chart.canvas.addEventListener('keydown', (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    step_point(chart, step);
  });
}
