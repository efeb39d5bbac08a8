'use strict';
// The page: editors, what the program says of their texts, curves, a beam. All that is said of a law
// is said by the program's own commands; the page only shows it.

const $ = id => document.getElementById(id);
let words = {}, table = null, chosen = null, wasm = null;

/* --- the program --------------------------------------------------------------------------------- */

async function start(wasmBinary) {
  wasm = wasmBinary;
  await open_program(wasm, [...files.values()]);
  for (const line of program.ccall('play_words', 'string', [], []).trim().split('\n')) {
    const [kind, ...all] = line.split(' ');
    words[kind] = new Set(all);
  }
  $('picker').hidden = true;
  $('state').textContent = '';
  choose();
}

async function begin() {
  try {
    const answer = await fetch('playground.wasm');
    if (!answer.ok) throw new Error(answer.status);
    await start(await answer.arrayBuffer());
  } catch (refused) {
    $('state').textContent = '';
    $('picker').hidden = false;
  }
}

/* --- texts that come along ------------------------------------------------------------------------ */

const files = new Map();
for (const s of document.querySelectorAll('script[type="text/plain"]'))
  files.set(s.dataset.name, { name: s.dataset.name, text: s.textContent.replace(/^\n/, '') });

// Exercises, and models that have a path of their own.
function beginnings() {
  const list = [];
  for (const name of files.keys()) {
    const exercise = name.match(/^course\/([^/]+)\/starter\.plm$/);
    if (exercise) list.push({ title: 'exercise ' + exercise[1].replace(/_/g, ' '), law: name, exercise: 'course/' + exercise[1],
      path: `course/${exercise[1]}/public.nml`, task: `course/${exercise[1]}/task.md` });
    const model = name.match(/^models\/(.+)\.plm$/);
    if (model && files.has(`drives/${model[1]}.nml`))
      list.push({ title: model[1], law: name, path: `drives/${model[1]}.nml` });
  }
  return list.sort((a, b) => !a.exercise - !b.exercise || a.title.localeCompare(b.title));
}

const text_of = name => (files.has(name) ? files.get(name).text : '');

function choose() {
  chosen = beginnings()[$('choice').selectedIndex];
  $('law').value = text_of(chosen.law);
  // the law on the command line counts; a path that names one would look for another file
  $('path').value = text_of(chosen.path);
  $('task').textContent = chosen.task ? text_of(chosen.task) : '';
  $('task').hidden = !$('task').textContent;
  $('deck').value = text_of('beam.nml');
  $('marking').hidden = !chosen.exercise;
  forget_marks();
  judge();
}

/* --- the law's text, coloured --------------------------------------------------------------------- */

const pattern = /(!.*$)|("[^"\n]*"?|'[^'\n]*')|(\[[^\]\n]*\])|((?<![A-Za-z0-9_])(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?)|([A-Za-z_]\w*)|(\?)/gm;

// A bracket after a number, a hole or the name of a parameter holds a unit.
function class_of(line, match) {
  if (match[1]) return 'comment';
  if (match[2]) return 'string';
  if (match[3]) return /(^\s*parameter\s+\w+|\d\.?|\?)\s*$/.test(line.slice(0, match.index)) ? 'unit' : '';
  if (match[4]) return 'number';
  if (match[6]) return 'hole';
  const first = line.slice(0, match.index).trim() === '';
  if (first && words.statement.has(match[5])) return 'statement';
  for (const kind of ['reserved', 'quantity', 'function']) if (words[kind].has(match[5])) return kind;
  return '';
}

function piece(text, name) {
  const s = document.createElement('span');
  s.textContent = text;
  if (name) s.className = name;
  return s;
}

// `wrong`: where the line is wrong, from and to, in characters from 0.
function coloured(line, wrong) {
  const out = document.createDocumentFragment();
  let at = 0;
  const put = (text, name, from) => {
    const cuts = [from, from + text.length];
    for (const w of wrong) for (const c of [w.from, w.to]) if (c > from && c < from + text.length) cuts.push(c);
    cuts.sort((a, b) => a - b);
    for (let k = 0; k + 1 < cuts.length; k++) {
      const inside = wrong.some(w => cuts[k] >= w.from && cuts[k + 1] <= w.to);
      out.append(piece(line.slice(cuts[k], cuts[k + 1]), [name, inside ? 'wrong' : ''].join(' ').trim()));
    }
  };
  for (const match of line.matchAll(pattern)) {
    if (match.index > at) put(line.slice(at, match.index), '', at);
    put(match[0], class_of(line, match), match.index);
    at = match.index + match[0].length;
  }
  if (at < line.length) put(line.slice(at), '', at);
  return out;
}

function show(messages) {
  const lines = $('law').value.split('\n'), shown = document.createDocumentFragment(), gutter = document.createDocumentFragment();
  lines.forEach((line, k) => {
    const here = messages.filter(m => m.where && m.where.file === 'law.plm' && m.where.line === k + 1);
    const wrong = here.map(m => ({ from: m.where.column - 1, to: m.where.end_line === k + 1 ? m.where.end_column - 1 : line.length }));
    shown.append(coloured(line, wrong));
    if (here.length) shown.append(piece(here[0].message + (here.length > 1 ? ` (and ${here.length - 1} more)` : ''), 'said ' + here[0].severity));
    shown.append('\n');
    gutter.append(piece(String(k + 1), here.length ? here[0].severity : ''), '\n');
  });
  $('shown').replaceChildren(shown);
  $('gutter').replaceChildren(gutter);
}

/* --- what is said ---------------------------------------------------------------------------------- */

function go_to(line) {
  const lines = $('law').value.split('\n'), at = lines.slice(0, line - 1).join('\n').length + (line > 1 ? 1 : 0);
  $('law').focus();
  $('law').setSelectionRange(at, at + lines[line - 1].length);
}

function message_item(m) {
  const li = document.createElement('li');
  li.className = m.severity;
  if (m.where && m.where.file === 'law.plm') {
    const b = document.createElement('button');
    b.textContent = `line ${m.where.line}`;
    b.onclick = () => go_to(m.where.line);
    li.append(b, ': ');
  } else if (m.where) {
    li.append(`${m.where.file}, line ${m.where.line}: `);
  }
  li.append(`${m.message} [${m.code}]`);
  if (m.hint) li.append(piece(m.hint, 'hint'));
  if (m.note) li.append(piece(m.note.message, 'hint'));
  return li;
}

function one_item(text, name) {
  const li = document.createElement('li');
  li.textContent = text;
  li.className = name;
  return li;
}

function list_messages(where, messages, good) {
  where.replaceChildren(...(messages.length ? messages.map(message_item) : [one_item(good, 'good')]));
}

/* --- equations ------------------------------------------------------------------------------------- */

function explain() {
  const said = command('explain', 'law.plm');
  const out = [];
  if (said.status === 0)
    for (const [, formula] of said.out.matchAll(/\$\$([\s\S]*?)\$\$/g)) {
      const mathml = program.ccall('play_formula', 'string', ['string'], [formula.trim()]);
      const tree = new DOMParser().parseFromString(mathml, 'text/html').querySelector('math');
      if (tree) out.push(document.importNode(tree, true));
    }
  $('equations').replaceChildren(...(out.length ? out : [piece('They stand here when the law has no errors.', 'quiet')]));
}

/* --- curves ---------------------------------------------------------------------------------------- */

function nice_step(span) {
  const p = Math.pow(10, Math.floor(Math.log10(span / 4)));
  for (const f of [1, 2, 5, 10]) if (span / (f * p) <= 5) return f * p;
  return 10 * p;
}

function short_number(v) {
  return v === 0 ? '0' : String(Number(v.toPrecision(6)));
}

// Returns how a place in the picture is a place of the curve, for reading it off.
function draw_curve(canvas, xs, ys, x_name, y_name, colour) {
  const c = canvas.getContext('2d'), W = canvas.width, H = canvas.height, left = 78, right = 14, top = 14, bottom = 40;
  c.clearRect(0, 0, W, H);
  const finite = xs.map((x, k) => [x, ys[k]]).filter(([x, y]) => isFinite(x) && isFinite(y));
  if (!finite.length) return null;
  const range = k => {
    let lo = Math.min(0, ...finite.map(p => p[k])), hi = Math.max(0, ...finite.map(p => p[k]));
    return lo === hi ? [lo - 1, hi + 1] : [lo, hi];
  };
  const [x0, x1] = range(0), [y0, y1] = range(1);
  const X = x => left + (x - x0) / (x1 - x0) * (W - left - right), Y = y => H - bottom - (y - y0) / (y1 - y0) * (H - top - bottom);
  c.font = '12px system-ui, sans-serif';
  c.fillStyle = '#4a5360';
  c.strokeStyle = '#e3e6ea';
  c.textAlign = 'center';
  for (let s = nice_step(x1 - x0), v = Math.ceil(x0 / s) * s; v <= x1 + s * 1e-9; v += s) {
    c.beginPath(); c.moveTo(X(v), top); c.lineTo(X(v), H - bottom); c.stroke();
    const text = short_number(Math.abs(v) < s * 1e-9 ? 0 : v), half = c.measureText(text).width / 2;
    c.fillText(text, Math.min(X(v), W - 2 - half), H - bottom + 15);
  }
  c.textAlign = 'right';
  for (let s = nice_step(y1 - y0), v = Math.ceil(y0 / s) * s; v <= y1 + s * 1e-9; v += s) {
    c.beginPath(); c.moveTo(left, Y(v)); c.lineTo(W - right, Y(v)); c.stroke();
    c.fillText(short_number(Math.abs(v) < s * 1e-9 ? 0 : v), left - 6, Y(v) + 4);
  }
  c.textAlign = 'center';
  c.fillText(x_name, (left + W - right) / 2, H - 8);
  c.save(); c.translate(13, (top + H - bottom) / 2); c.rotate(-Math.PI / 2); c.fillText(y_name, 0, 0); c.restore();
  c.strokeStyle = colour;
  c.lineWidth = 2;
  c.beginPath();
  finite.forEach(([x, y], k) => (k ? c.lineTo(X(x), Y(y)) : c.moveTo(X(x), Y(y))));
  c.stroke();
  c.lineWidth = 1;
  return px => {
    let best = 0;
    finite.forEach(([x], k) => { if (Math.abs(X(x) - px) < Math.abs(X(finite[best][0]) - px)) best = k; });
    return finite[best];
  };
}

function read_table(csv) {
  const [head, ...rows] = csv.trim().split('\n');
  const names = head.split(','), columns = names.map(() => []);
  for (const row of rows) row.split(',').forEach((v, k) => columns[k].push(Number(v)));
  return { names, columns };
}

function fill(select, names, wanted) {
  const before = select.value;
  select.replaceChildren(...names.map(n => new Option(n, n)));
  const plain = n => n.replace(/ \[.*/, '');
  const found = names.find(n => n === before) || names.find(n => wanted.includes(plain(n)));
  if (found) select.value = found;
}

let reading = null;
function draw_table() {
  if (!table) return;
  const x = table.names.indexOf($('x').value), y = table.names.indexOf($('y').value);
  reading = draw_curve($('curve'), table.columns[x], table.columns[y], $('x').value, $('y').value, '#0b57a4');
}

/* --- a path ----------------------------------------------------------------------------------------- */

function expectation_item(e) {
  const unit = e.unit && e.unit !== '1' ? ' ' + e.unit : '';
  return one_item(`line ${e.line}: ${e.quantity} = ${short_number(e.found)}${unit}, expected ${short_number(e.expected)}${unit}`, e.passed ? 'pass' : 'fail');
}

function drive() {
  forget('drive.csv');
  table = null;
  write('path.nml', $('path').value);
  const said = command('drive', 'law.plm', 'path.nml', '--csv', 'drive.csv', '--json');
  let answer;
  try { answer = JSON.parse(said.out); } catch (broken) { answer = { diagnostics: [], error: said.err }; }
  const of_path = answer.diagnostics.filter(m => !m.where || m.where.file !== 'law.plm');
  list_messages($('path_messages'), of_path, answer.error || 'no errors');
  $('expectations').replaceChildren(...(answer.expectations || []).map(expectation_item));
  try { table = read_table(read('drive.csv')); } catch (missing) { /* it was not driven */ }
  if (!table) {
    $('curve').getContext('2d').clearRect(0, 0, $('curve').width, $('curve').height);
    return;
  }
  fill($('x'), table.names, ['stretch', 'strain_xx', 'theta_i']);
  fill($('y'), table.names, ['N', 'stress_xx']);
  draw_table();
}

/* --- marks ------------------------------------------------------------------------------------------- */

// Runs take up to half a minute, so a worker makes them and the page goes on.
let marker = null;

function forget_marks() {
  if (marker) marker.terminate();
  marker = null;
  $('marks').replaceChildren();
  $('marked').textContent = '';
}

function mark_item(item) {
  if (!item.judged) return one_item(`${item.title}: ${item.points}, judged by the teacher`, '');
  const li = one_item(`${item.title}: ${item.got} of ${item.points}`, item.got === item.points ? 'pass' : 'fail');
  for (const words of [item.words, item.state]) if (typeof words === 'string') li.append(piece(words, 'hint'));
  return li;
}

function show_marks(said) {
  forget_marks();
  let answer;
  try { answer = JSON.parse(said.out).answers[0]; } catch (broken) { answer = null; }
  if (!answer) {
    $('marks').replaceChildren(one_item(said.err || 'it could not be marked', 'fail'));
    return;
  }
  const sum = key => answer.items.filter(item => item.judged).reduce((all, item) => all + item[key], 0);
  $('marked').textContent = `${sum('got')} of the ${sum('points')} points that can be judged here`;
  const words = [answer.sentence, answer.trouble, ...answer.notes].filter(w => typeof w === 'string').map(w => one_item(w, 'fail'));
  $('marks').replaceChildren(...words, ...answer.items.map(mark_item));
}

function mark() {
  forget_marks();
  $('marked').textContent = 'being marked; runs take a while ...';
  const scripts = ['glue', 'program'].map(id => $(id).textContent + '\n');
  const at = URL.createObjectURL(new Blob(scripts, { type: 'text/javascript' }));
  marker = new Worker(at);
  marker.onmessage = answer => {
    URL.revokeObjectURL(at);
    show_marks(answer.data);
  };
  marker.onerror = trouble => show_marks({ out: '', err: trouble.message });
  const law = { name: 'law.plm', text: $('law').value };
  marker.postMessage({ wasm, files: [...files.values(), law], line: ['grade', chosen.exercise, 'law.plm', '--public', '--json'] });
}

/* --- the whole -------------------------------------------------------------------------------------- */

function judge() {
  if (!program) return;
  const begun = performance.now();
  write('law.plm', $('law').value);
  const answer = JSON.parse(command('check', 'law.plm', '--diagnostics=json').out);
  show(answer.diagnostics);
  list_messages($('messages'), answer.diagnostics, 'no errors, no warnings');
  explain();
  drive();
  $('state').textContent = `judged in ${Math.round(performance.now() - begun)} ms`;
  document.body.dataset.judged = String(Number(document.body.dataset.judged || 0) + 1);
}

let waiting = 0;
function later() {
  show([]);
  forget_marks();
  clearTimeout(waiting);
  waiting = setTimeout(judge, 300);
}

/* --- the beam ---------------------------------------------------------------------------------------- */

const number = (name, ...a) => program.ccall(name, 'number', a.map(() => 'number'), a);
const doubles = (at, count) => Array.from(new Float64Array(program.HEAP8.buffer, at, count));
let going = false;

function colour_of(damage) {
  const t = Math.min(1, Math.max(0, damage));
  return `rgb(${Math.round(60 + 170 * t)},${Math.round(110 - 70 * t)},${Math.round(170 - 140 * t)})`;
}

function draw_beam() {
  const canvas = $('beam'), c = canvas.getContext('2d'), n = number('beam_count');
  const at = doubles(number('beam_places'), 2 * n), moved = doubles(number('beam_moved'), 2 * n), damage = doubles(number('beam_damage'), n);
  let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity, most = 0;
  for (let p = 0; p < n; p++) {
    x0 = Math.min(x0, at[2 * p]); x1 = Math.max(x1, at[2 * p]);
    y0 = Math.min(y0, at[2 * p + 1]); y1 = Math.max(y1, at[2 * p + 1]);
    most = Math.max(most, Math.hypot(moved[2 * p], moved[2 * p + 1]));
  }
  const factor = most > 0 ? Math.min(200, 0.05 * (x1 - x0) / most) : 1, spare = 0.06 * (x1 - x0);
  x0 -= spare; x1 += spare; y0 -= spare; y1 += spare;
  const scale = Math.min((canvas.width - 20) / (x1 - x0), (canvas.height - 40) / (y1 - y0));
  const size = Math.max(2, scale * Math.sqrt((x1 - x0) * (y1 - y0) / n) * 0.45);
  c.clearRect(0, 0, canvas.width, canvas.height);
  for (let p = 0; p < n; p++) {
    c.fillStyle = colour_of(damage[p]);
    c.beginPath();
    c.arc(10 + (at[2 * p] + factor * moved[2 * p] - x0) * scale, canvas.height - 24 - (at[2 * p + 1] + factor * moved[2 * p + 1] - y0) * scale, size, 0, 2 * Math.PI);
    c.fill();
  }
  c.fillStyle = '#4a5360';
  c.font = '12px system-ui, sans-serif';
  c.fillText(`displacements ${short_number(Number(factor.toPrecision(2)))} times as large; red: damaged`, 10, canvas.height - 8);
}

function series(k) {
  return doubles(number('beam_series', k), number('beam_samples'));
}

function monitor(name) {
  for (let k = 0; k < 16; k++) {
    const found = program.ccall('beam_series_name', 'string', ['number'], [k]);
    if (!found) return -1;
    if (found === name) return k;
  }
  return -1;
}

function draw_load() {
  const load = monitor('load'), cmod = monitor('cmod');
  if (load < 0) return;
  const x = cmod < 0 ? series(-1) : series(cmod).map(v => 1e3 * v);
  draw_curve($('load'), x, series(load).map(v => v / 1e3), cmod < 0 ? 'time [s]' : 'crack mouth opening [mm]', 'load [kN]', '#b3261e');
}

function end_beam(text) {
  going = false;
  $('break').disabled = false;
  $('stop').disabled = true;
  $('beam_state').textContent = text;
  document.body.dataset.beam = 'ended';
}

function step_beam() {
  if (!going) return;
  const begun = performance.now();
  let status = 0;
  while (status === 0 && performance.now() - begun < 60) status = number('beam_step', 20);
  draw_beam();
  draw_load();
  $('beam_state').textContent = `t = ${(1e3 * number('beam_time')).toFixed(3)} ms, ${Math.round(100 * number('beam_progress'))} %`;
  if (status === 0) requestAnimationFrame(step_beam);
  else end_beam(status === 1 ? `ended at t = ${(1e3 * number('beam_time')).toFixed(3)} ms` : 'the law went bad');
}

function break_beam() {
  printed = [];
  complained = [];
  write('law.plm', $('law').value);
  write('beam.nml', $('deck').value);
  document.body.dataset.beam = 'going';
  if (!program.ccall('beam_open', 'number', ['string'], ['beam.nml'])) {
    end_beam(complained.join('\n').split('\n')[0] || 'the beam cannot be built of this law');
    return;
  }
  going = true;
  $('break').disabled = true;
  $('stop').disabled = false;
  step_beam();
}

/* --- the beginning ----------------------------------------------------------------------------------- */

$('law').addEventListener('input', later);
$('path').addEventListener('input', later);
$('choice').addEventListener('change', choose);
$('x').addEventListener('change', draw_table);
$('y').addEventListener('change', draw_table);
$('break').addEventListener('click', break_beam);
$('mark').addEventListener('click', mark);
$('stop').addEventListener('click', () => end_beam('stopped'));
$('format').addEventListener('click', () => {
  write('law.plm', $('law').value);
  const said = command('format', 'law.plm');
  if (said.status === 0) $('law').value = said.out + '\n';
  judge();
});
$('law').addEventListener('keydown', event => {
  if (event.key !== 'Tab' || event.shiftKey) return;
  event.preventDefault();
  $('law').setRangeText('  ', $('law').selectionStart, $('law').selectionEnd, 'end');
  later();
});
$('curve').addEventListener('mousemove', event => {
  if (!reading) return;
  const box = $('curve').getBoundingClientRect(), p = reading((event.clientX - box.left) * $('curve').width / box.width);
  $('reading').textContent = `${short_number(p[0])}, ${short_number(p[1])}`;
});
$('wasm').addEventListener('change', async () => {
  if ($('wasm').files.length) await start(await $('wasm').files[0].arrayBuffer());
});
for (const b of beginnings()) $('choice').append(new Option(b.title));
begin();
