// Draws 16 live signals with a band from least to most, with one library. measure.py asks for updates and reads the times.
//
// Each signal has 2400 points: 30 s at 20 blocks a second with four points each. An update moves all of them on by one block.

import { Painter } from "./painter.js";

const kSignals = 16;
const kPoints = 2400;
const kPointsPerUpdate = 4;
const kSecondsPerPoint = 30 / kPoints;
const kWidth = 380;
const kHeight = 200;

function point(signal, index) {
  const t = index * kSecondsPerPoint;
  const middle = Math.sin(2 * Math.PI * (1 + signal / 8) * t) * Math.exp(-0.02 * t) + 0.2 * Math.sin(37 * t + signal);
  return [t, middle - 0.05, middle, middle + 0.05];
}

/** Columns of one signal: time, least, last, most; a new array for each update, as when blocks arrive. */
function columns(signal, first) {
  const [t, least, last, most] = [0, 1, 2, 3].map(() => new Array(kPoints));
  for (let i = 0; i < kPoints; ++i) [t[i], least[i], last[i], most[i]] = point(signal, first + i);
  return { t, least, last, most };
}

function element() {
  const box = document.createElement("div");
  box.className = "chart";
  document.body.append(box);
  return box;
}

const makers = {
  /** Draws nothing: what the browser and the making of the data take. */
  idle() {
    return () => () => {};
  },

  dygraphs() {
    const rows = (c) => c.t.map((t, i) => [t, [c.least[i], c.last[i], c.most[i]]]);
    return (first) => {
      const chart = new Dygraph(element(), rows(first), {
        customBars: true, labels: ["t", "signal"], legend: "never", width: kWidth, height: kHeight,
      });
      return (next) => chart.updateOptions({ file: rows(next) });
    };
  },

  chart_js() {
    const points = (t, y) => t.map((x, i) => ({ x, y: y[i] }));
    const sets = (c) => [points(c.t, c.least), points(c.t, c.most), points(c.t, c.last)];
    return (first) => {
      const canvas = document.createElement("canvas");
      element().append(canvas);
      const look = { pointRadius: 0, borderWidth: 1 };
      const chart = new Chart(canvas, {
        type: "line",
        data: {
          datasets: sets(first).map((data, i) => ({
            ...look, data, borderColor: i < 2 ? "transparent" : "#0072b2",
            backgroundColor: "rgba(0,114,178,0.2)", fill: i === 1 ? "-1" : false,
          })),
        },
        options: {
          animation: false, parsing: false, normalized: true, spanGaps: true, maintainAspectRatio: false,
          plugins: { legend: { display: false }, tooltip: { enabled: false } }, scales: { x: { type: "linear" } },
        },
      });
      return (next) => {
        sets(next).forEach((data, i) => { chart.data.datasets[i].data = data; });
        chart.update("none");
      };
    };
  },

  uplot() {
    const data = (c) => [c.t, c.last, c.least, c.most];
    return (first) => {
      const chart = new uPlot({
        width: kWidth, height: kHeight, legend: { show: false }, scales: { x: { time: false } },
        series: [{}, { stroke: "#0072b2" }, { stroke: "transparent" }, { stroke: "transparent" }],
        bands: [{ series: [3, 2], fill: "rgba(0,114,178,0.2)" }],
      }, data(first), element());
      return (next) => chart.setData(data(next));
    };
  },

  /** The painter of the page, report/live/page/painter.js. */
  painter() {
    const style = { colour: "target", dash: [], width: 1.5 };
    return (first) => {
      const canvas = document.createElement("canvas");
      element().append(canvas);
      const painter = new Painter(canvas, () => {});
      return (next) => painter.histories([{ points: next, factor: 1, style }], next.t[0], next.t[kPoints - 1]);
    };
  },

  /** Every point of two paths on a canvas, without axes or labels. */
  canvas() {
    return () => {
      const canvas = document.createElement("canvas");
      canvas.width = kWidth;
      canvas.height = kHeight;
      element().append(canvas);
      const pen = canvas.getContext("2d");
      return (next) => {
        const x = (i) => (i / kPoints) * kWidth;
        const y = (value) => (1 - value / 1.5) * kHeight / 2;
        pen.clearRect(0, 0, kWidth, kHeight);
        pen.beginPath();
        next.least.forEach((value, i) => pen.lineTo(x(i), y(value)));
        for (let i = kPoints - 1; i >= 0; --i) pen.lineTo(x(i), y(next.most[i]));
        pen.fillStyle = "rgba(0,114,178,0.2)";
        pen.fill();
        pen.beginPath();
        next.last.forEach((value, i) => pen.lineTo(x(i), y(value)));
        pen.strokeStyle = "#0072b2";
        pen.stroke();
      };
    };
  },
};

/** Draws `updates` updates, 20 a second; gives the time of each in the script [ms], and the times between them [ms]. */
window.measure = (library, updates, done) => {
  const make = makers[library]();
  const charts = [];
  for (let i = 0; i < kSignals; ++i) charts.push(make(columns(i, 0)));
  const script_ms = [];
  const between_ms = [];
  let begin = 0;
  let count = 0;
  const timer = setInterval(() => {
    const data = charts.map((chart, i) => columns(i, (count + 1) * kPointsPerUpdate));
    requestAnimationFrame(async () => {
      const now = performance.now();
      if (count > 0) between_ms.push(now - begin);
      begin = now;
      charts.forEach((draw, i) => draw(data[i]));
      await new Promise((resolve) => { queueMicrotask(() => queueMicrotask(resolve)); });  // uPlot draws there
      script_ms.push(performance.now() - begin);
      if (++count === updates) {
        clearInterval(timer);
        setTimeout(() => done({ script_ms, between_ms }), 200);
      }
    });
  }, 50);
};
