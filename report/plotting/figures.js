// Zoom, values under the pointer, and saving, for the figures that svg_canvas.cpp draws. Without it the figures stand as
// they are. A panel says in its data attributes what its box shows; zooming moves the window onto its curves.
'use strict';
(() => {
  const SVG = 'http://www.w3.org/2000/svg';
  const TICKS = 8;
  const NEAR_PX = 6;  // a mark is named, and a drag is a drag

  const element = (name, attributes, text) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };

  const short = value => {
    if (value === 0) return '0';
    const size = Math.abs(value);
    return size >= 1e6 || size < 1e-4 ? value.toExponential(3) : String(Number(value.toPrecision(5)));
  };

  // Values of an axis between low and high, as axis.cpp chooses them.
  const ticks = (low, high, logarithmic) => {
    if (logarithmic && high - low >= 0.7) {
      const found = [];
      const few = high - low < 2.5;
      for (let decade = Math.floor(low); decade <= high; ++decade) {
        for (const factor of few ? [1, 2, 5] : [1]) {
          const value = factor * 10 ** decade;
          const at = Math.log10(value);
          if (at >= low - 1e-9 && at <= high + 1e-9) found.push([at, short(value)]);
        }
      }
      return found;
    }
    const from = logarithmic ? 10 ** low : low;
    const to = logarithmic ? 10 ** high : high;
    const rough = (to - from) / TICKS;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 5].find(factor => factor * power >= rough * 0.999) || 10);
    const decimals = Math.max(0, Math.min(12, Math.ceil(-Math.log10(step))));
    const found = [];
    for (let i = Math.ceil(from / step - 1e-9); i * step <= to + 1e-9 * step; ++i) {
      found.push([logarithmic ? Math.log10(i * step) : i * step, String(Number((i * step).toFixed(decimals)))]);
    }
    return found;
  };

  // The places of a curve in its window; null between its pieces.
  const places = path => {
    const found = [];
    for (const piece of path.getAttribute('d').split('M').slice(1)) {
      const numbers = piece.split(/[l ]/).map(Number);
      if (found.length) found.push(null);
      let x = 0;
      let y = 0;
      for (let i = 0; i + 1 < numbers.length; i += 2) found.push([x += numbers[i], y += numbers[i + 1]]);
    }
    return found;
  };

  class Panel {
    constructor(group) {
      this.group = group;
      this.window = group.querySelector('.window');
      this.axes = group.querySelector('.axes');
      const number = name => Number(this.window.getAttribute(name));
      this.box = {x: number('x'), y: number('y'), width: number('width'), height: number('height')};
      [this.xLow, this.xHigh] = group.dataset.x.split(' ').map(Number);
      [this.yLow, this.yHigh] = group.dataset.y.split(' ').map(Number);
      this.xLog = 'xLog' in group.dataset;
      this.yLog = 'yLog' in group.dataset;
      this.title = group.dataset.title;
      this.xLabel = group.dataset.xLabel;
      this.yLabel = group.dataset.yLabel;
      this.view = {x: 0, y: 0, width: this.box.width, height: this.box.height};
      this.cursor = element('path', {fill: 'none', stroke: '#888', 'stroke-width': 1,
        'vector-effect': 'non-scaling-stroke', 'pointer-events': 'none', d: ''});
    }
    get curves() {
      this.read ??= [...this.window.querySelectorAll('path[data-name]')].map(path => {
        const points = places(path);
        return {name: path.dataset.name, colour: path.getAttribute('stroke'), points,
          isHistory: points.every((p, i) => !p || !points[i - 1] || p[0] >= points[i - 1][0])};
      });
      return this.read;
    }
    valueX(x) {
      const value = this.xLow + x / this.box.width * (this.xHigh - this.xLow);
      return this.xLog ? 10 ** value : value;
    }
    valueY(y) {
      const value = this.yHigh - y / this.box.height * (this.yHigh - this.yLow);
      return this.yLog ? 10 ** value : value;
    }
    show(view) {
      const {width, height} = this.box;
      view.width = Math.min(Math.max(view.width, width * 1e-4), width);
      view.height = Math.min(Math.max(view.height, height * 1e-4), height);
      view.x = Math.min(Math.max(view.x, 0), width - view.width);
      view.y = Math.min(Math.max(view.y, 0), height - view.height);
      this.view = view;
      this.window.setAttribute('viewBox', `${view.x} ${view.y} ${view.width} ${view.height}`);
      this.drawAxes();
    }
    drawAxes() {
      const {box, view} = this;
      const perX = (this.xHigh - this.xLow) / box.width;
      const perY = (this.yHigh - this.yLow) / box.height;
      const low = {x: this.xLow + view.x * perX, y: this.yHigh - (view.y + view.height) * perY};
      const high = {x: low.x + view.width * perX, y: this.yHigh - view.y * perY};
      this.axes.replaceChildren();
      const grid = (x1, y1, x2, y2) => this.axes.append(element('line', {x1, y1, x2, y2, stroke: '#e4e4e4'}));
      const label = (x, y, anchor, text) => this.axes.append(
        element('text', {x, y, 'font-size': 11, 'text-anchor': anchor, fill: '#222'}, text));
      for (const [value, text] of ticks(low.x, high.x, this.xLog)) {
        const x = box.x + (value - low.x) / (high.x - low.x) * box.width;
        grid(x, box.y, x, box.y + box.height);
        label(x, box.y + box.height + 15, 'middle', text);
      }
      for (const [value, text] of ticks(low.y, high.y, this.yLog)) {
        const y = box.y + box.height - (value - low.y) / (high.y - low.y) * box.height;
        grid(box.x, y, box.x + box.width, y);
        label(box.x - 5, y + 4, 'end', text);
      }
    }
    // Of each curve, the point nearest to a place of the window.
    nearest(at) {
      const scale = this.box.height / this.box.width * this.view.width / this.view.height;
      return this.curves.map(curve => {
        let best = null;
        let least = Infinity;
        for (const p of curve.points) {
          if (!p) continue;
          const across = Math.abs(p[0] - at.x);
          const distance = curve.isHistory ? across : Math.hypot(across, (p[1] - at.y) * scale);
          if (distance < least) [least, best] = [distance, p];
        }
        return {curve, point: best};
      }).filter(found => found.point);
    }
    marksNear(x) {
      const near = NEAR_PX * this.view.width / this.box.width;
      return [...this.window.querySelectorAll('.mark')]
        .filter(mark => Math.abs(parseFloat(mark.getAttribute('d').slice(1)) - x) <= near)
        .map(mark => mark.dataset.text);
    }
    rows() {
      const {x, y, width, height} = this.view;
      const inside = p => p && p[0] >= x && p[0] <= x + width && p[1] >= y && p[1] <= y + height;
      const quoted = text => `"${text.replaceAll('"', '""')}"`;
      return this.curves.flatMap(curve => curve.points.filter(inside).map(p => [
        quoted(this.title), quoted(curve.name), quoted(this.xLabel), this.valueX(p[0]).toPrecision(8),
        quoted(this.yLabel), this.valueY(p[1]).toPrecision(8)].join(',')));
    }
  }

  const save = (name, content) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(content);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };

  const readout = document.createElement('div');
  readout.className = 'readout';
  readout.hidden = true;
  readout.setAttribute('role', 'status');
  document.body.append(readout);

  class Figure {
    constructor(svg) {
      this.svg = svg;
      this.panels = [...svg.querySelectorAll('.panel')].map(group => new Panel(group));
      this.name = (svg.getAttribute('aria-label') || 'figure').replace(/[^a-z0-9]+/gi, '_').slice(0, 60);
      this.addTools();
      if (this.panels.length === 0) return;
      svg.tabIndex = 0;
      svg.addEventListener('pointermove', event => this.move(event));
      svg.addEventListener('pointerleave', () => this.drag || this.hide());
      svg.addEventListener('pointerdown', event => this.press(event));
      svg.addEventListener('pointerup', event => this.release(event));
      svg.addEventListener('pointercancel', () => this.endDrag());
      svg.addEventListener('dblclick', () => this.reset());
      svg.addEventListener('keydown', event => this.key(event));
      svg.addEventListener('blur', () => this.hide());
    }
    addTools() {
      const tools = document.createElement('div');
      tools.className = 'figure-tools';
      const button = (text, label, action) => {
        const made = document.createElement('button');
        made.type = 'button';
        made.textContent = text;
        made.title = label;
        made.setAttribute('aria-label', label);
        made.addEventListener('click', action);
        tools.append(made);
      };
      if (this.panels.length) {
        button('whole', 'Show the whole figure again', () => this.reset());
        button('CSV', 'Save the values shown as CSV', () => this.saveCsv());
      }
      button('SVG', 'Save the figure as SVG', () => this.saveSvg());
      button('PNG', 'Save the figure as PNG', () => this.savePng());
      if (this.panels.length) tools.append('drag: zoom, double click: whole; keys: ← → + − 0');
      this.svg.after(tools);
    }
    // Where an event is: the panel and the place in the window onto its curves.
    locate(event) {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
      const panel = this.drag?.panel || this.panels.find(({box}) =>
        at.x >= box.x && at.x <= box.x + box.width && at.y >= box.y && at.y <= box.y + box.height);
      return panel && {panel, place: this.inWindow(panel, at)};
    }
    inWindow({box, view}, at) {
      const share = (value, low, size) => Math.min(Math.max((value - low) / size, 0), 1);
      return {x: view.x + share(at.x, box.x, box.width) * view.width,
        y: view.y + share(at.y, box.y, box.height) * view.height};
    }
    move(event) {
      const found = this.locate(event);
      if (!found) return this.hide();
      if (this.drag) return this.stretch(found.place);
      this.tell(found.panel, found.place, event.clientX, event.clientY);
    }
    tell(panel, place, left, top) {
      const near = panel.nearest(place);
      if (near.length === 0) return this.hide();
      this.hide();
      this.at = {panel, place};
      panel.window.append(panel.cursor);
      panel.cursor.setAttribute('d', `M${place.x} 0l0 ${panel.box.height}`);
      readout.replaceChildren(`${panel.xLabel}: ${short(panel.valueX(place.x))}`);
      for (const {curve, point} of near) {
        const swatch = document.createElement('i');
        swatch.style.background = curve.colour;
        const where = curve.isHistory ? '' : `${short(panel.valueX(point[0]))}, `;
        readout.append('\n', swatch, `${curve.name}: ${where}${short(panel.valueY(point[1]))}`);
      }
      readout.append(`\n${panel.yLabel}`, ...panel.marksNear(place.x).map(text => `\n${text}`));
      readout.hidden = false;
      const size = readout.getBoundingClientRect();
      const room = {x: document.documentElement.clientWidth, y: document.documentElement.clientHeight};
      readout.style.left = `${left + 16 + size.width < room.x ? left + 16 : Math.max(0, left - 16 - size.width)}px`;
      readout.style.top = `${Math.max(0, Math.min(top + 12, room.y - size.height))}px`;
    }
    hide() {
      readout.hidden = true;
      for (const panel of this.panels) panel.cursor.remove();
    }
    press(event) {
      const found = event.button === 0 && event.pointerType !== 'touch' && this.locate(event);
      if (!found) return;
      event.preventDefault();
      this.svg.focus({preventScroll: true});
      this.svg.setPointerCapture(event.pointerId);
      this.drag = {...found, rectangle: element('rect', {fill: '#0072b2', 'fill-opacity': 0.15})};
      found.panel.window.append(this.drag.rectangle);
    }
    // A range of the horizontal axis; of both axes if the pointer also moves up or down.
    range(to) {
      const {panel, place} = this.drag;
      const near = NEAR_PX * panel.view.height / panel.box.height;
      const isTall = Math.abs(to.y - place.y) > 3 * near;
      return {x: Math.min(place.x, to.x), width: Math.abs(to.x - place.x),
        y: isTall ? Math.min(place.y, to.y) : panel.view.y,
        height: isTall ? Math.abs(to.y - place.y) : panel.view.height};
    }
    stretch(to) {
      this.hide();
      for (const [key, value] of Object.entries(this.range(to))) this.drag.rectangle.setAttribute(key, value);
    }
    release(event) {
      const found = this.drag && this.locate(event);
      if (found) {
        const {panel} = this.drag;
        const wanted = this.range(found.place);
        if (wanted.width * panel.box.width > NEAR_PX * panel.view.width) this.zoom(panel, wanted);
      }
      this.endDrag();
    }
    endDrag() {
      this.drag?.rectangle.remove();
      this.drag = null;
    }
    // Panels over the same axis zoom together.
    zoom(panel, view) {
      for (const other of this.panels) {
        if (other === panel) {
          other.show({...view});
        } else if (other.group.dataset.x === panel.group.dataset.x && other.xLabel === panel.xLabel) {
          const ratio = other.box.width / panel.box.width;
          other.show({...other.view, x: view.x * ratio, width: view.width * ratio});
        }
      }
    }
    reset() {
      this.hide();
      for (const panel of this.panels) panel.show({x: 0, y: 0, width: panel.box.width, height: panel.box.height});
    }
    key(event) {
      const panel = this.at?.panel || this.panels[0];
      const {view} = panel;
      const x = this.at?.place.x ?? view.width / 2;
      const y = this.at?.place.y ?? view.height / 2;
      const step = view.width / 100;
      const around = factor => this.zoom(panel, {...view, x: x - (x - view.x) * factor, width: view.width * factor});
      const to = next => {
        const place = {x: Math.min(Math.max(next, view.x), view.x + view.width), y};
        const point = new DOMPoint(panel.box.x + (place.x - view.x) / view.width * panel.box.width, panel.box.y)
          .matrixTransform(this.svg.getScreenCTM());
        this.tell(panel, place, point.x, point.y);
      };
      const actions = {ArrowLeft: () => to(x - step), ArrowRight: () => to(x + step), '+': () => around(0.5),
        '=': () => around(0.5), '-': () => around(2), 0: () => this.reset(), Escape: () => this.reset()};
      if (!(event.key in actions) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      actions[event.key]();
    }
    text() {
      this.hide();
      return new XMLSerializer().serializeToString(this.svg);
    }
    saveSvg() { save(`${this.name}.svg`, new Blob([this.text()], {type: 'image/svg+xml'})); }
    saveCsv() {
      const rows = ['panel,curve,x_axis,x,y_axis,y', ...this.panels.flatMap(panel => panel.rows())];
      save(`${this.name}.csv`, new Blob([rows.join('\n') + '\n'], {type: 'text/csv'}));
    }
    savePng() {
      const image = new Image();
      image.onload = () => {
        const canvas = document.createElement('canvas');
        const {width, height} = this.svg.viewBox.baseVal;
        canvas.width = 2 * width;
        canvas.height = 2 * height;
        canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
        canvas.toBlob(content => save(`${this.name}.png`, content), 'image/png');
      };
      image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(this.text())}`;
    }
  }

  for (const svg of document.querySelectorAll('svg.figure')) new Figure(svg);
})();
