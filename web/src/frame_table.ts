// The frames as a table, those that lost something first. Any column sorts; choosing a row moves the scrubber. Only the
// rows in sight are built, so that walks of thousands of frames stay quick.
import type { Walk, WalkFrame } from './data.ts';
import { element } from './dom.ts';
import { count, significant } from './format.ts';
import type { Store } from './store.ts';

interface Column {
  name: string;
  key: (frame: WalkFrame) => number | null | undefined;
  text: (value: number | null | undefined) => string;
}

const COLUMNS: Column[] = [
  { name: 'Frame', key: (frame) => frame.frame, text: count },
  { name: 'Lost', key: (frame) => frame.missed, text: count },
  { name: 'Candidates', key: (frame) => frame.candidates, text: count },
  { name: 'In frustum', key: (frame) => frame.frustum, text: count },
  { name: 'Drawn', key: (frame) => frame.visible, text: count },
  { name: 'Truly seen', key: (frame) => frame.truth, text: count },
  { name: 'Drawn/seen', key: (frame) => (frame.truth ? frame.visible / frame.truth : null), text: (value) => (value ? `${significant(value)} ×` : '–') },
  { name: 'Cull, ms', key: (frame) => frame.cull_ms, text: significant },
  { name: 'Truth, ms', key: (frame) => frame.truth_ms, text: significant },
  { name: 'Triangles', key: (frame) => frame.triangles_submitted, text: count },
];

const ROW = 30, SIGHT = 14, SPARE = 6;
const LOST_COLUMN = 1;

export function frame_table(walk: Walk, store: Store): HTMLElement {
  return new FrameTable(walk, store).root;
}

class FrameTable {
  readonly root: HTMLElement;
  private readonly body = element('tbody');
  private readonly headers: HTMLElement[];
  private readonly scroller: HTMLElement;
  private order: number[] = [];
  private sorted_by = LOST_COLUMN;
  private descending = true;

  constructor(private readonly walk: Walk, private readonly store: Store) {
    this.headers = COLUMNS.map((column, index) => element('th', { scope: 'col' },
      element('button', { type: 'button', onclick: () => this.sort_by(index) }, column.name)));
    const table = element('table', { class: 'frames', 'aria-rowcount': walk.frame_count + 1 },
      element('caption', { class: 'hidden' }, 'Frames of the walk; choosing a row moves the scrubber'),
      element('thead', {}, element('tr', {}, ...this.headers)), this.body);
    this.scroller = element('div', { class: 'scroller', tabindex: 0, role: 'region', 'aria-label': 'Table of frames', onscroll: () => this.draw() }, table);
    this.scroller.style.maxHeight = `${(SIGHT + 1) * ROW + 6}px`;
    this.root = element('section', { 'aria-labelledby': 'frames-title' }, element('h2', { id: 'frames-title' }, 'All frames'), this.scroller);
    store.on(['run'], () => this.sort());
    store.on(['frame'], () => this.draw());
  }

  private sort_by(column: number): void {
    this.descending = column === this.sorted_by ? !this.descending : column !== 0;
    this.sorted_by = column;
    this.sort();
    this.scroller.scrollTop = 0;
  }

  /** Equal rows keep the order of the walk; missing values come last. */
  private sort(): void {
    const frames = this.walk.runs[this.store.get('run')].frames, key = COLUMNS[this.sorted_by].key;
    const sign = this.descending ? -1 : 1;
    this.order = frames.map((_, index) => index).sort((a, b) => {
      const first = key(frames[a]) ?? null, second = key(frames[b]) ?? null;
      if (first === second) return a - b;
      if (first === null) return 1;
      if (second === null) return -1;
      return sign * (first - second);
    });
    this.headers.forEach((header, index) =>
      header.setAttribute('aria-sort', index !== this.sorted_by ? 'none' : this.descending ? 'descending' : 'ascending'));
    this.draw();
  }

  private draw(): void {
    const first = Math.max(0, Math.floor(this.scroller.scrollTop / ROW) - SPARE);
    const last = Math.min(this.order.length, first + SIGHT + 2 * SPARE);
    const gap = (rows: number) => (rows > 0 ? element('tr', { class: 'gap', 'aria-hidden': 'true', style: `height: ${rows * ROW}px` }) : null);
    const rows = this.order.slice(first, last).map((index, at) => this.row(index, first + at));
    this.body.replaceChildren(...[gap(first), ...rows, gap(this.order.length - last)].filter((row) => row !== null));
  }

  private row(index: number, position: number): HTMLElement {
    const frame = this.walk.runs[this.store.get('run')].frames[index];
    const current = index === this.store.get('frame');
    return element('tr', { class: frame.missed ? 'losing' : '', 'aria-current': current ? 'true' : null, 'aria-rowindex': position + 2,
                           onclick: () => this.store.set({ frame: index, playing: false }) },
      ...COLUMNS.map((column) => element('td', {}, column.text(column.key(frame)))));
  }
}
