// Curves over the frames of the walk: counts, cull time, triangles submitted; all methods over each other. The curves and
// the scrubber share one cursor: pressing or dragging in a plot scrubs, scrubbing moves the line in every plot.
import uPlot from 'uplot';
import type { Walk, WalkFrame } from './data.ts';
import { choice, colour, element } from './dom.ts';
import { median } from './figures.ts';
import { count, short_count, short_decimal, significant } from './format.ts';
import type { Store } from './store.ts';

type Read = (frame: WalkFrame) => number | null | undefined;
type Curve = { label: string; colour: string; read: Read; run: number; dash?: number[]; width?: number; points?: boolean };

interface PlotKind {
  title: string;
  unit: string;
  format: (value: number | null) => string;
  mark: (value: number) => string;  // at the axis
  logarithmic: boolean;
  curves: (walk: Walk) => Curve[];
  absent: string;
}

const HEIGHT = 190, TALL = 250;
const WIDE_SPREAD = 15;  // of the largest to the typical small count, from which on a linear scale would squash the small

const PLOTS: PlotKind[] = [
  {
    title: 'Objects', unit: '', format: (value) => count(value), mark: short_count, logarithmic: true, absent: 'No objects were counted.',
    curves: count_curves,
  },
  {
    title: 'Cull time', unit: 'ms', format: (value) => (value === null ? '–' : `${significant(value)} ms`), mark: short_decimal, logarithmic: false,
    absent: 'Cull times were not measured.',
    curves: (walk) => walk.runs.map((run, index) => own(run.method, 'cull', index, walk, '--time', (frame) => frame.cull_ms)),
  },
  {
    title: 'Triangles submitted', unit: '', format: (value) => short_count(value), mark: short_count, logarithmic: false, absent: 'Submitted triangles were not counted.',
    curves: (walk) => walk.runs.map((run, index) => own(run.method, 'submitted', index, walk, '--triangles', (frame) => frame.triangles_submitted)),
  },
];

/** Marks of the logarithmic axis: zero and powers of ten. */
function powers(_: uPlot, __: number, ___: number, most: number): number[] {
  const marks = [0];
  for (let power = 1; power <= most; power *= 10) marks.push(power);
  return marks;
}

/** The curve of one method: named and coloured by the method where there are several, else by what it tells. */
function own(method: string, what: string, run: number, walk: Walk, single: string, read: Read): Curve {
  return walk.runs.length > 1 ? { label: method, colour: `--run-${run % 6}`, read, run } : { label: what, colour: single, read, run };
}

/** How many times the most in a frustum exceeds what is seen, or else drawn, in a typical frame. */
function spread(walk: Walk): number {
  const most = walk.runs[0].frames.reduce((value, frame) => Math.max(value, frame.frustum ?? 0), 0);
  const small = median(walk.runs[0].frames.map((frame) => frame.truth ?? frame.visible)) ?? most;
  return most / Math.max(1, small);
}

/** Frustum and truth are the same for every method; what is drawn and lost is its own. */
function count_curves(walk: Walk): Curve[] {
  const several = walk.runs.length > 1;
  const drawn = walk.runs.map((run, index): Curve => ({
    label: several ? `drawn, ${run.method}` : 'drawn', colour: several ? `--run-${index % 6}` : '--drawn', read: (frame) => frame.visible, run: index, width: 2,
  }));
  const lost = walk.runs.map((run, index): Curve => ({
    label: several ? `lost, ${run.method}` : 'lost', colour: '--lost', read: (frame) => frame.missed || null, run: index, points: true, width: 1.4,
  }));
  return [
    { label: 'in frustum', colour: '--frustum', read: (frame) => frame.frustum, run: 0 }, ...drawn,
    { label: 'truly seen', colour: '--truth', read: (frame) => frame.truth, run: 0, dash: [5, 3], width: 1.6 },
    ...lost,
  ];
}

export function plots(walk: Walk, store: Store): HTMLElement {
  const root = element('section', { 'aria-labelledby': 'plots-title' }, element('h2', { id: 'plots-title' }, 'Frame by frame'));
  const grid = element('div', { class: 'plots' });
  root.append(grid);
  for (const [index, kind] of PLOTS.entries()) grid.append(new Plot(walk, store, kind, index === 0).root);
  return root;
}

class Plot {
  readonly root: HTMLElement;
  private readonly body = element('div', { class: 'plot-body' });
  private readonly playhead = element('div', { class: 'playhead', 'aria-hidden': 'true' });
  private plot: uPlot | null = null;
  private logarithmic: boolean;

  constructor(private readonly walk: Walk, private readonly store: Store, private readonly kind: PlotKind, private readonly wide: boolean) {
    const bar = element('div', { class: 'bar' }, element('h3', {}, kind.unit ? `${kind.title}, ${kind.unit}` : kind.title));
    this.logarithmic = kind.logarithmic && spread(walk) > WIDE_SPREAD;
    if (kind.logarithmic)
      bar.append(choice('Scale', [{ value: 'linear', text: 'linear' }, { value: 'log', text: 'log' }], this.logarithmic ? 'log' : 'linear', (value) => {
        this.logarithmic = value === 'log';
        this.build();
      }).root);
    this.root = element('div', { class: wide ? 'plot wide' : 'plot', role: 'group', 'aria-label': `${kind.title} per frame` }, bar, this.body);
    if (!this.curves().length) {
      this.body.append(element('p', { class: 'absent' }, kind.absent));
      return;
    }
    store.on(['theme'], () => this.build());
    store.on(['frame'], () => this.move_playhead());
    new ResizeObserver(() => this.plot?.setSize(this.size())).observe(this.body);
  }

  /** Curves that hold at least one number. */
  private curves(): Curve[] {
    return this.kind.curves(this.walk).filter((curve) => this.walk.runs[curve.run].frames.some((frame) => typeof curve.read(frame) === 'number'));
  }

  private size(): { width: number; height: number } {
    return { width: Math.max(200, this.body.clientWidth), height: this.wide ? TALL : HEIGHT };
  }

  private build(): void {
    this.plot?.destroy();
    const curves = this.curves();
    const positions = Array.from({ length: this.walk.frame_count }, (_, index) => index);
    const data = [positions, ...curves.map((curve) => positions.map((index) => {
      const frame = this.walk.frame(curve.run, index);
      return (frame && curve.read(frame)) ?? null;
    }))];
    this.plot = new uPlot(this.options(curves), data as uPlot.AlignedData, this.body);
    this.plot.over.append(this.playhead);
    this.listen(this.plot.over);
  }

  private options(curves: Curve[]): uPlot.Options {
    const ink = colour('--quiet'), line = { stroke: colour('--grid'), width: 1 };
    const axis = { stroke: ink, grid: line, ticks: { ...line, size: 5 }, font: '12px system-ui, sans-serif' };
    const name = (index: number) => this.walk.frame(0, index)?.frame ?? index;
    const format = (value: number | null) => (value === null || value === undefined ? '–' : this.kind.format(value));
    return {
      ...this.size(),
      padding: [10, 12, 0, 0],
      cursor: { sync: { key: 'sightline' }, drag: { x: false, y: false }, points: { size: 7 } },
      legend: { live: true, markers: { width: 0, fill: (_, index) => (index ? colour(curves[index - 1].colour) : 'transparent') } },
      hooks: { ready: [() => this.move_playhead()], setSize: [() => this.move_playhead()],
               setCursor: [(plot) => { if ((plot.cursor.left ?? -1) < 0) this.show_values(); }],
               drawClear: [(plot) => this.shade_losses(plot)] },
      scales: {
        x: { time: false, range: (_, low, high) => (low === high ? [low - 0.5, high + 0.5] : [low, high]) },
        y: this.logarithmic ? { distr: 4, asinh: 1, range: (_, __, high) => [0, high > 0 ? high * 1.3 : 1] } : { range: (_, __, high) => [0, high > 0 ? high * 1.06 : 1] },
      },
      axes: [
        { ...axis, size: 32, values: (_, marks) => marks.map((mark) => (Number.isInteger(mark) ? String(name(mark)) : '')) },
        { ...axis, size: 58, values: (_, marks) => marks.map((mark) => (mark === null ? null : this.kind.mark(mark))) as string[],
          ...(this.logarithmic ? { splits: powers } : {}) },
      ],
      series: [
        { label: 'frame', value: (_, index) => (index === null ? '–' : String(name(index))) },
        ...curves.map((curve): uPlot.Series => ({
          label: curve.label, stroke: colour(curve.colour), width: curve.width ?? 1.6, dash: curve.dash,
          points: { show: false }, value: (_, value) => format(value),
          ...(curve.points ? { fill: `${colour(curve.colour)}40`, paths: uPlot.paths.bars?.({ size: [0.9, 12, 2] }) } : {}),
        })),
      ],
    };
  }

  /** Pressing puts the scrubber there, dragging takes it along. */
  private listen(over: HTMLElement): void {
    const scrub = (event: PointerEvent) => {
      const left = event.clientX - over.getBoundingClientRect().left;
      this.store.set({ frame: this.plot?.posToVal(left, 'x') ?? 0, playing: false });
    };
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      scrub(event);
    });
    over.addEventListener('pointermove', (event) => { if (event.buttons & 1) scrub(event); });
  }

  /** A column behind every frame in which a method lost something, as high as the plot so that one object is not missed. */
  private shade_losses(plot: uPlot): void {
    if (!this.wide) return;
    const { left, top, width, height } = plot.bbox, column = Math.max(2 * devicePixelRatio, width / Math.max(1, this.walk.frame_count - 1));
    plot.ctx.save();
    plot.ctx.fillStyle = `${colour('--lost')}2e`;
    for (let index = 0; index < this.walk.frame_count; ++index) {
      if (!this.walk.runs.some((run) => run.frames[index]?.missed)) continue;
      const x = Math.max(left, plot.valToPos(index, 'x', true) - column / 2);
      plot.ctx.fillRect(x, top, Math.min(column, left + width - x), height);
    }
    plot.ctx.restore();
  }

  private move_playhead(): void {
    if (!this.plot) return;
    this.playhead.style.transform = `translateX(${this.plot.valToPos(this.store.get('frame'), 'x')}px)`;
    this.show_values();
  }

  /** Without a pointer in the plot its legend tells of the frame of the scrubber. */
  private show_values(): void {
    this.plot?.setLegend({ idx: this.store.get('frame') }, false);
  }
}
