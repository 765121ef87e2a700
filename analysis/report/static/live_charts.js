"use strict";
// Two plots of a reading's change: over time, and along a path. The size of a change stands on a scale of powers of ten.

/** The methods of a live page in the order of their bars: what tells their lines apart besides colour. */
const METHODS = [
  { name: "model", method: "exact", dash: [] },
  { name: "formula", method: "formula", dash: [7, 4] },
  { name: "reduced", method: "reduced", dash: [2, 3] },
];
const CHART = { low: 1e-16, high: 1e-10 };  // F, the ends of the scale

/** A change in F as text; `error` may be missing. */
function farads(value, error) {
  if (value === null || value === undefined) return "not known";
  if (!Number.isFinite(value)) return "contact";
  const unit = Math.max(Math.abs(value), error || 0) < 1e-13 ? [1e-15, "fF"] : [1e-12, "pF"];
  const digits = x => { const s = Math.abs(x / unit[0]); return s === 0 ? 1 : Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(s)))); };
  const minus = text => text.replace("-", "−");
  if (error === null || error === undefined) return `${minus(String(+(value / unit[0]).toFixed(digits(value))))} ${unit[1]}`;
  const places = error === 0 ? digits(value) : Math.max(0, Math.min(6, 1 - Math.floor(Math.log10(error / unit[0]))));
  return `${minus((value / unit[0]).toFixed(places))} ± ${(error / unit[0]).toFixed(places)} ${unit[1]}`;
}

/** The place of a size on the scale: 0 at its low end, 1 at its high end. */
const placeOnScale = size => Math.min(1, Math.max(0, Math.log10(Math.max(size, CHART.low) / CHART.low) / Math.log10(CHART.high / CHART.low)));
const powers = () => [-16, -15, -14, -13, -12, -11, -10].map(power => [10 ** power, power < -12 ? `${10 ** (power + 15)} fF` : `${10 ** (power + 12)} pF`]);

/** Draws a plot: lines {points: [[x, F]], colour, dash, name}, marks {x, value, error, colour}, a threshold, a place on the x axis. */
function drawChart(canvas, { from, to, ticks, lines, marks = [], threshold, now }, theme) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2), box = canvas.getBoundingClientRect();
  if (canvas.width !== Math.round(box.width * ratio)) canvas.width = Math.round(box.width * ratio);
  if (canvas.height !== Math.round(box.height * ratio)) canvas.height = Math.round(box.height * ratio);
  const pen = canvas.getContext("2d"), [left, right, top, bottom] = [46, 66, 8, 22];
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, box.width, box.height);
  pen.font = "11px system-ui, sans-serif";
  const sizes = [...lines.flatMap(l => l.points.map(p => Math.abs(p[1]))), ...marks.map(m => Math.abs(m.value)), threshold || 0].filter(s => s > 0 && Number.isFinite(s));
  if (!sizes.length) return;
  const low = 10 ** Math.floor(Math.log10(Math.max(Math.min(...sizes), 1e-17))), high = 10 ** Math.ceil(Math.log10(Math.max(...sizes) * 1.0001));
  const x = value => left + (value - from) / (to - from || 1) * (box.width - left - right);
  const y = size => top + (1 - Math.log10(Math.max(Math.abs(size), low) / low) / (Math.log10(high / low) || 1)) * (box.height - top - bottom);
  pen.lineWidth = 1;
  for (let power = Math.round(Math.log10(low)); power <= Math.round(Math.log10(high)); ++power) {
    const size = 10 ** power, at = y(size);
    pen.strokeStyle = theme.line;
    pen.beginPath(); pen.moveTo(left, at); pen.lineTo(box.width - right, at); pen.stroke();
    pen.fillStyle = theme.soft; pen.textAlign = "right";
    pen.fillText(size < 0.99e-12 ? `${+(size * 1e15).toPrecision(1)} fF` : `${+(size * 1e12).toPrecision(1)} pF`, left - 4, at + 4);
  }
  pen.textAlign = "center";
  for (const [value, text] of ticks) pen.fillText(text, x(value), box.height - 6);
  if (threshold) {
    pen.strokeStyle = theme.ink; pen.setLineDash([5, 4]); pen.lineWidth = 1.5;
    pen.beginPath(); pen.moveTo(left, y(threshold)); pen.lineTo(box.width - right, y(threshold)); pen.stroke();
    pen.setLineDash([]);
    pen.textAlign = "left"; pen.fillStyle = theme.ink;
    pen.fillText("threshold", left + 4, y(threshold) - 4);
  }
  if (now !== undefined) {
    pen.strokeStyle = theme.soft; pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(x(now), top); pen.lineTo(x(now), box.height - bottom); pen.stroke();
  }
  const taken = [];
  for (const { points, colour, dash, name } of lines) {
    const drawn = points.filter(p => p[1] !== null && p[1] !== 0 && Number.isFinite(p[1]));
    if (!drawn.length) continue;
    pen.strokeStyle = colour; pen.fillStyle = colour; pen.lineWidth = 2; pen.setLineDash(dash);
    pen.beginPath();
    drawn.forEach((p, k) => (k ? pen.lineTo(x(p[0]), y(p[1])) : pen.moveTo(x(p[0]), y(p[1]))));
    pen.stroke(); pen.setLineDash([]);
    let height = y(drawn[drawn.length - 1][1]) + 4;
    while (taken.some(other => Math.abs(other - height) < 12)) height += 12;
    taken.push(height);
    pen.textAlign = "left";
    pen.fillText(name, box.width - right + 5, height);
  }
  for (const { at, value, error, colour } of marks) {
    pen.strokeStyle = colour; pen.lineWidth = 2;
    const [a, b] = [Math.abs(value) + error, Math.max(Math.abs(value) - error, low)].map(y);
    pen.beginPath();
    pen.moveTo(x(at), a); pen.lineTo(x(at), b);
    for (const end of [a, b]) { pen.moveTo(x(at) - 3, end); pen.lineTo(x(at) + 3, end); }
    pen.rect(x(at) - 3.5, y(value) - 3.5, 7, 7);
    pen.stroke();
  }
}
