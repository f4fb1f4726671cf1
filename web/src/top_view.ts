// The 2-D panel: the scene from above, what was drawn and what was culled, the view of the frame. Works without WebGL.
// Drag to move, click and scroll to zoom; hovering names the object.
import { EXTRA, HIDDEN, LOST, OUTSIDE, SEEN, STATE_NAMES, UNKNOWN, type Vector, type Walk } from './data.ts';
import { colour, element } from './dom.ts';
import { metres } from './format.ts';
import type { Placement } from './placement.ts';
import type { Store } from './store.ts';
import { describe_object, Tooltip } from './tooltip.ts';

const DRAWING_ORDER = [UNKNOWN, OUTSIDE, HIDDEN, EXTRA, SEEN, LOST];

export function top_view(walk: Walk, place: Placement, store: Store): HTMLElement {
  return new TopView(walk, place, store).root;
}

class TopView {
  readonly root: HTMLElement;
  private readonly canvas = element('canvas', { tabindex: 0, 'aria-label': 'Scene from above, objects coloured by state. Hover for names, drag to move, click and scroll to zoom.' });
  private readonly tooltip = new Tooltip();
  private readonly scale = element('span', { class: 'scale' });
  private zoom = 1;
  private middle: [number, number] = [0, 0];  // world x and z, around the common centre, in the middle of the canvas
  private waiting = false;

  constructor(private readonly walk: Walk, private readonly place: Placement, private readonly store: Store) {
    const reset = element('button', { type: 'button', class: 'quiet', onclick: () => { this.zoom = 1; this.middle = [0, 0]; this.wake(); } }, 'Fit');
    this.root = element('div', { class: 'panel plan' },
      element('div', { class: 'bar' }, element('h3', {}, 'From above'), reset),
      element('div', { class: 'stage' }, this.canvas, this.scale, this.tooltip.root));
    store.on(['frame', 'frozen', 'run', 'shown', 'cut', 'theme', 'selected'], () => this.wake());
    new ResizeObserver(() => this.wake()).observe(this.canvas.parentElement as HTMLElement);
    this.listen();
  }

  private listen(): void {
    let last: [number, number] | null = null;
    this.canvas.addEventListener('pointerdown', (event) => {
      last = [event.clientX, event.clientY];
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointerup', () => { last = null; });
    this.canvas.addEventListener('pointermove', (event) => {
      if (!last) return this.hover(event);
      this.tooltip.hide();
      this.middle = [this.middle[0] - (event.clientX - last[0]) / this.pixels(), this.middle[1] - (event.clientY - last[1]) / this.pixels()];
      last = [event.clientX, event.clientY];
      this.wake();
    });
    this.canvas.addEventListener('pointerleave', () => { this.tooltip.hide(); this.canvas.blur(); });
    this.canvas.addEventListener('dblclick', (event) => {
      const id = this.object_under(event);
      this.store.set({ selected: id >= 0 ? id : null });
    });
    this.canvas.addEventListener('wheel', (event) => {
      if (document.activeElement !== this.canvas && !event.ctrlKey) return;
      event.preventDefault();
      const [x, z] = this.world(event);
      const factor = Math.max(0.5, Math.min(200, this.zoom * Math.exp(-event.deltaY * 0.0016))) / this.zoom;
      this.zoom *= factor;
      this.middle = [x + (this.middle[0] - x) / factor, z + (this.middle[1] - z) / factor];
      this.wake();
    }, { passive: false });
  }

  /** Pixels per metre. */
  private pixels(): number {
    const { lo, hi } = this.place.frame;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return this.zoom * Math.min(width / (1.06 * Math.max(1e-6, hi[0] - lo[0])), height / (1.06 * Math.max(1e-6, hi[2] - lo[2])));
  }

  private world(event: MouseEvent): [number, number] {
    const { left, top, width, height } = this.canvas.getBoundingClientRect(), scale = this.pixels();
    return [this.middle[0] + (event.clientX - left - width / 2) / scale, this.middle[1] + (event.clientY - top - height / 2) / scale];
  }

  private wake(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  private states(): Uint8Array | null {
    const camera = this.walk.state_camera(this.store.get('run'), this.store.state_frame);
    return camera && this.walk.states(this.store.get('run'), camera.frame);
  }

  private cut(): number {
    return this.store.get('cut') - this.place.centre[1];
  }

  private draw(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas, ratio = devicePixelRatio || 1;
    const context = this.canvas.getContext('2d');
    if (!context || width === 0 || height === 0) return;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    context.scale(ratio, ratio);
    context.fillStyle = colour('--space');
    context.fillRect(0, 0, width, height);
    const scale = this.pixels();
    const x = (value: number) => width / 2 + (value - this.middle[0]) * scale;
    const y = (value: number) => height / 2 + (value - this.middle[1]) * scale;
    this.draw_objects(context, x, y, scale, width, height);
    this.draw_path(context, x, y);
    this.draw_view(context, x, y);
    this.draw_selected(context, x, y);
    this.draw_scale(scale);
  }

  private draw_objects(context: CanvasRenderingContext2D, x: (v: number) => number, y: (v: number) => number, scale: number, width: number, height: number): void {
    const states = this.states(), shown = this.store.get('shown'), cut = this.cut(), box = this.place.local;
    const by_state: number[][] = DRAWING_ORDER.map(() => []);
    for (let id = 0; id < this.place.count; ++id) {
      const state = states ? Math.min(states[id], UNKNOWN) : UNKNOWN;
      if (shown[state] && box[6 * id + 1] < cut) by_state[state].push(id);
    }
    for (const state of DRAWING_ORDER) {
      const tint = colour(`--${STATE_NAMES[state]}`);
      context.fillStyle = tint;
      context.strokeStyle = state === OUTSIDE || state === UNKNOWN ? colour('--outside-edge') : colour('--space');
      context.lineWidth = 0.6;
      for (const id of by_state[state]) {
        const left = x(box[6 * id]), top = y(box[6 * id + 2]);
        const wide = Math.max(state === LOST ? 4 : 1.2, (box[6 * id + 3] - box[6 * id]) * scale);
        const deep = Math.max(state === LOST ? 4 : 1.2, (box[6 * id + 5] - box[6 * id + 2]) * scale);
        if (left > width || top > height || left + wide < 0 || top + deep < 0) continue;
        if (this.place.enclosing[id]) {
          context.save();
          context.strokeStyle = tint;
          context.strokeRect(left, top, wide, deep);
          context.restore();
          continue;
        }
        context.fillRect(left, top, wide, deep);
        if (wide > 5 && deep > 5) context.strokeRect(left, top, wide, deep);
      }
      if (state === LOST) this.ring(context, by_state[LOST], x, y);
    }
  }

  /** Lost objects may be tiny: a ring makes them findable. */
  private ring(context: CanvasRenderingContext2D, ids: number[], x: (v: number) => number, y: (v: number) => number): void {
    const box = this.place.local;
    context.strokeStyle = colour('--lost');
    context.lineWidth = 2;
    for (const id of ids) {
      const left = x(box[6 * id]), right = x(box[6 * id + 3]), top = y(box[6 * id + 2]), bottom = y(box[6 * id + 5]);
      context.beginPath();
      context.arc((left + right) / 2, (top + bottom) / 2, Math.max(9, Math.hypot(right - left, bottom - top) / 2 + 5), 0, 2 * Math.PI);
      context.stroke();
    }
  }

  private draw_path(context: CanvasRenderingContext2D, x: (v: number) => number, y: (v: number) => number): void {
    context.beginPath();
    this.place.eyes.forEach((eye, index) => (index ? context.lineTo(x(eye[0]), y(eye[2])) : context.moveTo(x(eye[0]), y(eye[2]))));
    context.strokeStyle = colour('--path');
    context.lineWidth = 1.8;
    context.lineJoin = 'round';
    context.stroke();
  }

  private draw_view(context: CanvasRenderingContext2D, x: (v: number) => number, y: (v: number) => number): void {
    const camera = this.walk.state_camera(this.store.get('run'), this.store.state_frame);
    if (camera) {
      const outline = hull(this.place.view_faces(camera).flat().map((corner: Vector) => [x(corner[0]), y(corner[2])]));
      context.beginPath();
      outline.forEach(([a, b], index) => (index ? context.lineTo(a, b) : context.moveTo(a, b)));
      context.closePath();
      context.globalAlpha = 0.1;
      context.fillStyle = context.strokeStyle = colour('--view');
      context.fill();
      context.globalAlpha = 1;
      context.lineWidth = 1.6;
      context.stroke();
    }
    const eye = this.walk.frame(this.store.get('run'), this.store.get('frame'))?.eye;
    if (!eye) return;
    const [ex, , ez] = this.place.inward(eye);
    context.beginPath();
    context.arc(x(ex), y(ez), 5, 0, 2 * Math.PI);
    context.fillStyle = colour('--view');
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = colour('--space');
    context.stroke();
  }

  private draw_selected(context: CanvasRenderingContext2D, x: (v: number) => number, y: (v: number) => number): void {
    const id = this.store.get('selected');
    if (id === null) return;
    const box = this.place.local.subarray(6 * id, 6 * id + 6);
    context.strokeStyle = colour('--ink');
    context.lineWidth = 2;
    context.strokeRect(x(box[0]) - 2, y(box[2]) - 2, x(box[3]) - x(box[0]) + 4, y(box[5]) - y(box[2]) + 4);
  }

  private draw_scale(scale: number): void {
    const rough = 90 / scale, power = 10 ** Math.floor(Math.log10(rough));
    const length = [5, 2, 1].map((step) => step * power).find((step) => step <= rough) ?? power;
    this.scale.textContent = metres(length);
    this.scale.style.setProperty('--length', `${length * scale}px`);
    this.scale.classList.add('ruler');
  }

  /** The smallest object under the pointer, of those drawn. */
  private object_under(event: MouseEvent): number {
    const [x, z] = this.world(event), slack = 2 / this.pixels();
    const states = this.states(), shown = this.store.get('shown'), cut = this.cut(), box = this.place.local;
    let best = -1, smallest = Infinity;
    for (let id = 0; id < this.place.count; ++id) {
      const at = 6 * id;
      if (x < box[at] - slack || x > box[at + 3] + slack || z < box[at + 2] - slack || z > box[at + 5] + slack) continue;
      if (this.place.enclosing[id] || box[at + 1] >= cut || !shown[states ? Math.min(states[id], UNKNOWN) : UNKNOWN]) continue;
      const area = (box[at + 3] - box[at]) * (box[at + 5] - box[at + 2]);
      if (area < smallest) {
        smallest = area;
        best = id;
      }
    }
    return best;
  }

  private hover(event: PointerEvent): void {
    const id = this.object_under(event), states = this.states();
    if (id < 0) return this.tooltip.hide();
    this.tooltip.show(event, describe_object(id, this.place, states, this.walk.checked(this.store.get('run'), this.store.state_frame)), STATE_NAMES[states ? Math.min(states[id], UNKNOWN) : UNKNOWN]);
  }
}

/** Convex hull of points in the plane, by Andrew's monotone chain. */
function hull(points: number[][]): number[][] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (o: number[], a: number[], b: number[]) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const half = (order: number[][]) => {
    const chain: number[][] = [];
    for (const point of order) {
      while (chain.length > 1 && turn(chain[chain.length - 2], chain[chain.length - 1], point) <= 0) chain.pop();
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}
