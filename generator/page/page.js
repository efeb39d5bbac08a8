"use strict";
/* The script of a page of `perilat report`: readings off curves, and the frames on a canvas, with a
   slider that moves the dots on the curves. Everything that the page says is there without it. */
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const SVG = "http://www.w3.org/2000/svg";
  /* Of diagrams, in the units of their pictures (plot_axes.h). */
  const FRAME = { left: 120, right: 1160, top: 70, bottom: 705 };
  const runs = new Map();

  /* --- numbers as packing.h writes them --- */

  function bytesOf(text) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
    return bytes;
  }
  const viewOf = (text) => new DataView(bytesOf(text).buffer);
  function doubles(text) {
    const view = viewOf(text), values = new Float64Array(view.byteLength / 8);
    for (let k = 0; k < values.length; k++) values[k] = view.getFloat64(8 * k, true);
    return values;
  }
  /* A reader of what stands one after the other. */
  function reader(text) {
    const bytes = bytesOf(text), view = new DataView(bytes.buffer);
    let at = 0;
    return {
      more: () => at < bytes.length,
      byte: () => bytes[at++],
      step: () => { at += 2; return view.getUint16(at - 2, true) / 65535; },
      float: () => { at += 4; return view.getFloat32(at - 4, true); },
      whole() {
        let number = 0, scale = 1, byte;
        do {
          byte = bytes[at++];
          number += (byte & 127) * scale;
          scale *= 128;
        } while (byte > 127);
        return number % 2 ? -(number + 1) / 2 : number / 2;
      },
    };
  }
  function unpackRuns(text, before, count) {
    const now = before ? before.slice() : new Uint8Array(count), from = reader(text);
    for (let at = 0; from.more();) {
      at += from.whole();
      for (let left = from.whole(); left > 0; left--, at++) now[at] = (now[at] + from.byte()) & 255;
    }
    return now;
  }

  /* As C's %.6g. */
  function shown(value) {
    if (!Number.isFinite(value)) return "-";
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-4 || size >= 1e6))
      return value.toExponential(5).replace(/\.?0+e/, "e").replace(/e([+-])(\d)$/, "e$10$2");
    return String(Number(value.toPrecision(6)));
  }
  const withUnit = (text, unit) => (unit && unit !== "1" ? text + " " + unit : text);

  function element(name, of, properties) {
    const made = document.createElement(name);
    Object.assign(made, properties);
    if (of) of.append(made);
    return made;
  }

  /* --- histories --- */

  function historyOf(key) {
    const run = data[key], numbers = reader(run.samples), series = new Map();
    const samples = [];
    for (let at = 0; numbers.more();) samples.push((at += numbers.whole()));
    series.set("", doubles(run.time));
    for (const s of run.series) series.set(s.name, doubles(s.values));
    return { samples, series, time: series.get("") };
  }
  /* How series are called before people. */
  const namesOf = (key) => new Map(data[key].series.map((s) => [s.name, s.shown || s.name]));
  function nearest(values, wanted) {
    let best = 0;
    for (let k = 1; k < values.length; k++)
      if (Math.abs(values[k] - wanted) < Math.abs(values[best] - wanted)) best = k;
    return best;
  }

  /* --- curves --- */

  function diagram(svg) {
    const axis = (text, from, to) => {
      const [low, high, factor] = text.split(" ").map(Number);
      return { factor, at: (value) => from + ((value * factor - low) / (high - low)) * (to - from) };
    };
    const x = axis(svg.dataset.x, FRAME.left, FRAME.right), y = axis(svg.dataset.y, FRAME.bottom, FRAME.top);
    const overName = svg.dataset.over;
    const curves = svg.dataset.series.split(";").filter(Boolean).map((item) => {
      const [ink, key] = item.split(":", 2), run = runs.get(key), name = item.slice(ink.length + key.length + 2);
      return { ink, name, run, values: run.history.series.get(name), over: run.history.series.get(overName) };
    });
    if (curves.length === 0) return;
    const stacked = svg.querySelector(".area") !== null, several = new Set(curves.map((c) => c.run)).size > 1;
    const reading = element("p", svg.closest("figure"), { className: "reading" });
    const shape = (name, properties) => {
      const made = document.createElementNS(SVG, name);
      for (const [key, value] of Object.entries(properties)) made.setAttribute(key, value);
      made.style.display = "none";
      svg.append(made);
      return made;
    };
    const read = stacked ? null : shape("circle", { class: "dot read", r: 6 });
    const put = (dot, c, k) => {
      const good = Number.isFinite(c.values[k]) && Number.isFinite(c.over[k]);
      dot.style.display = good ? "" : "none";
      if (!good) return;
      dot.setAttribute("cx", x.at(c.over[k]));
      dot.setAttribute("cy", y.at(c.values[k]));
    };
    /* What the frames show, on the curves: a line at their time, or a dot. */
    curves.forEach((c, n) => {
      const cursor = n === 0 && overName === "" ? shape("path", { class: "cursor" }) : null;
      const dot = stacked ? null : shape("circle", { class: "dot ink" + c.ink, r: 8 });
      c.run.watchers.push((k) => {
        if (dot) put(dot, c, k);
        if (!cursor || !Number.isFinite(c.over[k])) return;
        cursor.style.display = "";
        cursor.setAttribute("d", `M${x.at(c.over[k])} ${FRAME.top}V${FRAME.bottom}`);
      });
    });
    const tell = (c, k) => {
      const parts = [(overName ? c.run.names.get(overName) : data[c.run.key].timeName) + " " + withUnit(shown(c.over[k] * x.factor), svg.dataset.xUnit)];
      for (const of of stacked ? curves : [c])
        parts.push(of.run.names.get(of.name) + " " + withUnit(shown(of.values[k] * y.factor), svg.dataset.yUnit));
      reading.textContent = (several ? data[c.run.key].path + ":  " : "") + parts.join(",  ");
    };
    const placeOf = (event) => {
      const box = svg.getBoundingClientRect(), view = svg.viewBox.baseVal;
      return [view.x + ((event.clientX - box.left) / box.width) * view.width, view.y + ((event.clientY - box.top) / box.height) * view.height];
    };
    /* The sample nearest to the pointer: along x in a diagram over time, where curves do not turn. */
    const nearestTo = ([px, py]) => {
      let best = null, least = Infinity;
      for (const c of stacked ? curves.slice(0, 1) : curves)
        for (let k = 0; k < c.over.length; k++) {
          const dx = x.at(c.over[k]) - px, dy = y.at(c.values[k]) - py;
          const distance = overName ? dx * dx + dy * dy : Math.abs(dx) + (several ? 1e-3 * Math.abs(dy) : 0);
          if (distance < least) { least = distance; best = [c, k]; }
        }
      return best;
    };
    svg.addEventListener("pointermove", (event) => {
      const best = nearestTo(placeOf(event));
      if (!best) return;
      if (read) put(read, ...best);
      tell(...best);
    });
    svg.addEventListener("pointerleave", () => {
      if (read) read.style.display = "none";
      reading.textContent = "";
    });
    svg.addEventListener("click", (event) => {
      const best = nearestTo(placeOf(event));
      if (best && best[0].run.movie) best[0].run.movie.goTo(best[0].run.history.time[best[1]]);
    });
  }

  /* --- frames --- */

  function bodyOf(frames) {
    const extent = [frames.high[0] - frames.low[0], frames.high[1] - frames.low[1]];
    const count = frames.particles, places = new Float64Array(2 * count), from = reader(frames.places);
    for (let k = 0; k < 2 * count; k++) places[k] = frames.low[k % 2] + from.step() * extent[k % 2];
    const pairs = new Int32Array(2 * frames.bonds), bonds = reader(frames.pairs);
    for (let b = 0, i = 0; b < frames.bonds; b++) {
      i += bonds.whole();
      pairs[2 * b] = i;
      pairs[2 * b + 1] = i + bonds.whole();
    }
    const corners = new Int32Array(4 * frames.cellCount);
    if (frames.cellCount) {
      const cells = reader(frames.cells);
      for (let k = 0, node = 0; k < corners.length; k++) corners[k] = node += cells.whole();
    }
    const nodes = frames.nodes ? unpackRuns(frames.nodes, null, count) : null;
    return { extent, count, places, pairs, corners, nodes };
  }

  function movie(host, run) {
    const frames = data[run.key].frames;
    if (!frames) return null;
    const body = bodyOf(frames), total = frames.times.length, steps = frames.fields.map(() => []), motions = [];
    const canvas = element("canvas", host, { tabIndex: -1 });
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "the body in the frame that the slider is at");
    const key = element("div", host, { className: "key" });
    const controls = element("div", host, { className: "controls" });
    const play = element("button", controls, { type: "button", textContent: "Play" });
    const slider = element("input", controls, { type: "range", min: 0, max: total - 1, step: 1, value: 0 });
    slider.setAttribute("aria-label", "frame");
    const when = element("output", controls, { className: "when" });
    const row = element("div", host, { className: "controls" });
    const labelled = (text, name, properties) => {
      const label = element("label", row, { textContent: text + " " });
      return element(name, label, properties);
    };
    const choice = labelled("field", "select", {});
    frames.fields.forEach((f, n) => element("option", choice, { value: n, textContent: f.name + (f.unit ? " [" + f.unit + "]" : "") }));
    element("option", choice, { value: -1, textContent: "none" });
    const factor = labelled("displacements times", "input", { type: "number", min: 0, step: "any", value: frames.factor });
    let frame = 0, timer = 0;

    function stepsOf(n, k) {
      const f = frames.fields[n], all = steps[n], count = f.on === "bonds" ? frames.bonds : frames.particles;
      for (let i = all.length; i <= k; i++) all.push(unpackRuns(f.steps[i], i ? all[i - 1] : null, count));
      return all[k];
    }
    function motionOf(k) {
      if (motions[k]) return motions[k];
      const u = new Float32Array(2 * body.count), from = reader(frames.moved[k]);
      const low = frames.ranges[2 * k], range = (frames.ranges[2 * k + 1] - low) || 1;
      for (let n = 0; n < u.length; n++) u[n] = low + from.step() * range;
      return (motions[k] = u);
    }

    const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    /* Sound and separated bonds stand out from the paper, whatever it is. */
    const classInk = (n) => n === 0 ? style("--sound") : n === data.classes.length - 1 ? style("--ink") : data.classes[n].ink;
    const scaleInk = (step) => step ? data.scale[Math.min(data.scale.length - 1, Math.floor(((step - 1) / 254) * data.scale.length))] : style("--sound");
    function classOf(step) {
      if (step === 255) return data.classes.length - 1;
      const value = step ? (step - 1) / 254 : 0;
      let n = 0;
      while (n < data.classes.length - 2 && value > data.classes[n].upTo) n++;
      return n;
    }

    /* Lines of one colour at a time. */
    function strokes(draw, groups, widths, inks) {
      groups.forEach((path, n) => {
        if (!path) return;
        draw.strokeStyle = inks(n);
        draw.lineWidth = widths(n);
        draw.stroke(path);
      });
    }

    function drawCells(draw, at, steps, k, place) {
      if (!frames.cellCount) return;
      const alive = unpackRuns(frames.alive[k], null, frames.cellCount), groups = [];
      const add = (step, points) => {
        const n = step ? 1 + Math.floor(((step - 1) / 254) * 47.999) : 0;
        const path = groups[n] || (groups[n] = new Path2D());
        points.forEach((p, i) => (i ? path.lineTo(p[0], p[1]) : path.moveTo(p[0], p[1])));
        path.closePath();
      };
      const mean = (c) => {
        let sum = 0;
        for (let i = 0; i < 4; i++) {
          const step = steps[body.corners[4 * c + i]];
          if (!step) return 0;
          sum += step;
        }
        return sum / 4;
      };
      /* Few cells are shown in parts, between whose corners values go on bilinearly. */
      const fine = !steps ? 1 : frames.cellCount <= 2500 ? 3 : frames.cellCount <= 8000 ? 2 : 1;
      const between = (p, x, y, c) => (1 - y) * ((1 - x) * p[0][c] + x * p[1][c]) + y * ((1 - x) * p[3][c] + x * p[2][c]);
      for (let c = 0; c < frames.cellCount; c++) {
        if (alive[c] !== 1) continue;
        const corners = [0, 1, 2, 3].map((i) => at(body.corners[4 * c + i]));
        const own = [0, 1, 2, 3].map((i) => (steps ? [steps[body.corners[4 * c + i]]] : [0]));
        const whole = fine === 1 || own.some((s) => !s[0]);
        if (whole) add(steps ? mean(c) : 0, corners);
        for (let n = 0; n < (whole ? 0 : fine * fine); n++) {
          const x = (n % fine) / fine, y = Math.floor(n / fine) / fine, d = 1 / fine;
          add(between(own, x + d / 2, y + d / 2, 0), [[x, y], [x + d, y], [x + d, y + d], [x, y + d]]
            .map((q) => [between(corners, q[0], q[1], 0), between(corners, q[0], q[1], 1)]));
        }
      }
      const parts = reader(frames.parts[k]), low = frames.ranges[2 * k], range = (frames.ranges[2 * k + 1] - low) || 1;
      while (parts.more()) {
        const node = parts.whole(), points = [];
        for (let i = 0; i < 4; i++) {
          const p = [0, 0], u = [0, 0];
          for (let c = 0; c < 2; c++) {
            p[c] = frames.low[c] + parts.step() * body.extent[c];
            u[c] = low + parts.step() * range;
          }
          points.push(place(p[0], p[1], u[0], u[1]));
        }
        add(steps ? steps[node] : 0, points);
      }
      groups.forEach((path, n) => {
        if (!path) return;
        draw.fillStyle = draw.strokeStyle = n ? scaleInk(1 + ((n - 0.5) / 48) * 254) : style("--sound");
        draw.lineWidth = 0.7;
        draw.fill(path);
        draw.stroke(path);
      });
    }

    function drawFaces(draw, k, place) {
      if (!frames.cellCount) return;
      const faces = reader(frames.faces[k]);
      draw.strokeStyle = style("--ink");
      draw.lineWidth = 1.8;
      while (faces.more()) {
        const path = new Path2D(), count = faces.whole();
        for (let n = 0; n < count; n++) {
          const x = faces.float(), y = faces.float(), u = faces.float(), v = faces.float();
          const p = place(x, y, u, v);
          if (n) path.lineTo(p[0], p[1]);
          else path.moveTo(p[0], p[1]);
        }
        draw.stroke(path);
      }
    }

    function drawBonds(draw, at, field, steps, thick, scale) {
      const groups = [], count = field.damage ? data.classes.length : data.scale.length + 1, last = data.classes.length - 1;
      for (let b = 0; b < frames.bonds; b++) {
        const n = !field.damage ? (steps[b] ? 1 + Math.min(count - 2, Math.floor(((steps[b] - 1) / 254) * (count - 1))) : 0)
          : steps[b] ? classOf(steps[b]) : 0;
        const path = groups[n] || (groups[n] = new Path2D()), i = at(body.pairs[2 * b]), j = at(body.pairs[2 * b + 1]);
        if (field.damage && n === last) {
          crackLine(path, i, j, scale);
        } else {
          path.moveTo(i[0], i[1]);
          path.lineTo(j[0], j[1]);
        }
      }
      if (field.damage) strokes(draw, groups, (n) => (n === 0 ? 0.6 : n === last ? 1.6 : 1.4) * thick, classInk);
      else strokes(draw, groups, (n) => (n ? 1.8 : 0.6) * thick, (n) => (n ? data.scale[n - 1] : style("--sound")));
    }
    /* A separated bond: the edge between the two particles' cells, across the middle of the bond. */
    function crackLine(path, i, j, scale) {
      const dx = j[0] - i[0], dy = j[1] - i[1], half = (0.5 / Math.sqrt(3)) * frames.spacing * scale / Math.max(Math.hypot(dx, dy), 1e-9);
      const x = (i[0] + j[0]) / 2, y = (i[1] + j[1]) / 2;
      path.moveTo(x - dy * half, y + dx * half);
      path.lineTo(x + dy * half, y - dx * half);
    }
    function drawSeparated(draw, at, k, thick, scale) {
      const n = frames.fields.findIndex((f) => f.damage && f.on === "bonds");
      if (n < 0) return;
      const damage = stepsOf(n, k), path = new Path2D();
      for (let b = 0; b < frames.bonds; b++)
        if (damage[b] === 255) crackLine(path, at(body.pairs[2 * b]), at(body.pairs[2 * b + 1]), scale);
      draw.strokeStyle = style("--ink");
      draw.lineWidth = 1.6 * thick;
      draw.stroke(path);
    }

    function drawParticles(draw, at, field, steps, whole) {
      const ball = field && field.on === "particles";
      const radius = ball ? whole : Math.max(0.6, 0.2 * whole);
      const order = [...Array(body.count).keys()];
      if (ball && field.damage && !frames.surface) order.sort((p, q) => steps[p] - steps[q]);
      for (const p of order) {
        if (body.nodes && body.nodes[p]) continue;
        const here = at(p), none = ball && !steps[p];
        draw.fillStyle = !ball ? style("--quiet") : field.damage ? classInk(classOf(steps[p])) : scaleInk(steps[p]);
        draw.beginPath();
        draw.arc(here[0], here[1], none ? 0.3 * radius : radius, 0, 2 * Math.PI);
        draw.fill();
        if (ball && frames.surface && !none) {
          draw.strokeStyle = "rgba(40,40,45,.55)";
          draw.lineWidth = Math.min(1, 0.08 * radius);
          draw.stroke();
        }
      }
    }

    /* What all frames take, but not more than half a body beyond it. */
    function view(times) {
      const low = [...frames.low], high = [...frames.high];
      for (let k = 0; k < total; k++) {
        const u = motionOf(k);
        for (let n = 0; n < u.length; n++) {
          const c = n % 2, value = body.places[n] + times * u[n];
          if (value < low[c]) low[c] = value;
          if (value > high[c]) high[c] = value;
        }
      }
      const size = Math.max(...body.extent);
      for (let c = 0; c < 2; c++) {
        low[c] = Math.max(low[c], frames.low[c] - 0.3 * size) - frames.spacing;
        high[c] = Math.min(high[c], frames.high[c] + 0.3 * size) + frames.spacing;
      }
      return { low, high };
    }
    let seen = null, seenFactor = NaN;

    function paint() {
      const times = Number(factor.value) || 0, width = host.clientWidth - 30;
      if (times !== seenFactor) { seen = view(times); seenFactor = times; }
      const box = [seen.high[0] - seen.low[0], seen.high[1] - seen.low[1]];
      const scale = Math.min(width / box[0], Math.max(360, 0.8 * innerHeight) / box[1]);
      const height = Math.ceil(box[1] * scale), ratio = devicePixelRatio || 1;
      const left = (width - box[0] * scale) / 2;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      const draw = canvas.getContext("2d");
      draw.setTransform(ratio, 0, 0, ratio, 0, 0);
      draw.clearRect(0, 0, width, height);
      draw.lineCap = "round";
      const u = motionOf(frame);
      const place = (x, y, ux, uy) => [left + (x + times * ux - seen.low[0]) * scale, height - (y + times * uy - seen.low[1]) * scale];
      const at = (p) => place(body.places[2 * p], body.places[2 * p + 1], u[2 * p], u[2 * p + 1]);
      const field = frames.fields[choice.value] || null, now = field ? stepsOf(Number(choice.value), frame) : null;
      const thick = Math.max(0.5, 0.12 * frames.spacing * scale), onParticles = field && field.on === "particles";
      drawCells(draw, at, onParticles ? now : null, frame, place);
      if (field && field.on === "bonds") drawBonds(draw, at, field, now, thick, scale);
      if (!field) drawBonds(draw, at, { damage: true }, new Uint8Array(frames.bonds), thick, scale);
      drawParticles(draw, at, field, now, 0.5 * frames.spacing * scale);
      if (onParticles || !field) drawSeparated(draw, at, frame, thick, scale);
      drawFaces(draw, frame, place);
      tell(field);
    }

    function tell(field) {
      when.textContent = `frame ${frames.numbers[frame]} of ${frames.last}, ${frames.moments[frame]}`;
      key.replaceChildren();
      if (!field) return;
      if (field.damage) {
        data.classes.forEach((c, n) => {
          const item = element("span", key), sample = element("canvas", item, { width: 22, height: 10 });
          sample.style.width = "22px";
          sample.style.marginRight = "6px";
          const draw = sample.getContext("2d");
          draw.fillStyle = classInk(n);
          draw.fillRect(0, 3, 22, 5);
          item.append(c.text);
        });
        return;
      }
      element("span", key, { textContent: shown(field.range[0]) });
      const sample = element("canvas", key, { width: data.scale.length, height: 1 }), draw = sample.getContext("2d");
      data.scale.forEach((ink, n) => { draw.fillStyle = ink; draw.fillRect(n, 0, 1, 1); });
      element("span", key, { textContent: withUnit(shown(field.range[1]), field.unit) });
      element("span", key, { textContent: field.name });
    }

    function show(k, quiet) {
      frame = Math.max(0, Math.min(total - 1, k));
      slider.value = frame;
      paint();
      const sample = nearest(run.history.time, frames.times[frame]);
      run.watchers.forEach((watch) => watch(sample));
      host.dataset.frame = frames.numbers[frame];
      if (!quiet)
        for (const other of runs.values())
          if (other !== run && other.movie) other.movie.goTo(frames.times[frame], true);
    }
    const goTo = (time, quiet) => show(nearest(frames.times, time), quiet);
    const stop = () => { clearInterval(timer); timer = 0; play.textContent = "Play"; };
    slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
    choice.addEventListener("change", paint);
    factor.addEventListener("input", paint);
    play.addEventListener("click", () => {
      if (timer) return stop();
      play.textContent = "Stop";
      if (frame === total - 1) show(0);
      timer = setInterval(() => (frame === total - 1 ? stop() : show(frame + 1)), Math.max(60, 6000 / total));
    });
    new ResizeObserver(() => paint()).observe(host);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
    return { show, goTo, total };
  }

  /* --- all --- */

  for (const key of Object.keys(data))
    if (data[key].series) runs.set(key, { key, watchers: [], history: historyOf(key), names: namesOf(key), movie: null });
  document.querySelectorAll("svg.diagram[data-series]").forEach(diagram);
  for (const run of runs.values()) {
    const host = document.querySelector(`.movie[data-of="${run.key}"]`);
    if (host) run.movie = movie(host, run);
  }
  for (const run of runs.values())
    if (run.movie) run.movie.show(run.movie.total - 1, true);
  const first = document.querySelector(".main-curve svg.diagram[data-series]");
  if (first && [...runs.values()].some((run) => run.movie))
    element("p", first.closest("figure"), { className: "quiet",
      textContent: "The ring: the frame that is seen below. A click on a curve goes to the frame there." });
})();
