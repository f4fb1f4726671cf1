// The data of a walk as `sightline walk` writes it (schema sightline.walk/1), and what the panels ask of it. Parts may be
// absent: truth with --no-verify, everything under "report" in a bare walk. Nothing here touches the page.

export type Vector = [number, number, number];

/** Nothing was counted where a number is null. */
export interface WalkFrame {
  frame: number;
  eye: Vector;
  candidates: number;
  frustum: number;
  visible: number;
  truth: number | null;
  missed: number | null;
  unpromised?: number | null;  // of the missed: those that the method does not promise to find
  missed_ids?: number[] | null;
  cull_ms: number | null;
  truth_ms: number | null;
  triangles_submitted: number | null;
}

export interface Summary {
  missed?: number | null;
  overestimate?: number | null;
  cull_ms_median?: number | null;
  triangles_fraction?: number | null;
  verdict?: string;
  interrupted?: boolean;
  counters?: Record<string, number>;
}

export interface Run {
  method: string;
  promise?: string;
  frames: WalkFrame[];
  summary: Summary;
}

/** Camera and, where kept, object states of one frame; `far` is null when there is no far plane. A perspective camera has
 *  its full vertical angle `fov_y`, an orthographic one the height `span_y` of its picture instead. */
export interface StoredFrame {
  frame: number;
  method?: string;
  direction: Vector;
  up: Vector;
  right: Vector;
  fov_y: number | null;
  span_y?: number | null;
  aspect: number;
  near: number;
  far: number | null;
  state?: string | null;
}

export interface Picture {
  frame: number;
  kind: string;
  png: string;
}

/** A row of `sightline compare`. */
export interface ComparedMethod {
  method: string;
  promise: string;
  culled: number;
  found: number | null;
  missed: number;
  broken?: boolean;
  false_visible: number;
  lost_pixels: number;
  cull_ms_median: number;
  memory_bytes: number | null;
  counters_per_frame?: Record<string, number>;
  stages_ms: Record<'application' | 'geometry' | 'fill' | 'bus', number | null>;
  limited_by: string;
}

export interface Comparison {
  units: { ms_per_triangle: number; ms_per_pixel: number; ms_per_byte: number };
  methods: ComparedMethod[];
}

interface RawWalk {
  schema?: string;
  size?: [number, number];
  method?: string;
  promise?: string;
  samples?: number;
  scene?: { name?: string; objects?: number; triangles?: number };
  frames?: WalkFrame[];
  summary?: Summary;
  runs?: Run[];
  report?: {
    command?: string;
    version?: string;
    date?: string;
    objects?: { bounds?: string };
    frames?: StoredFrame[];
    pictures?: Picture[];
    comparison?: Comparison;
  };
}

export const OUTSIDE = 0, HIDDEN = 1, SEEN = 2, EXTRA = 3, LOST = 4, UNKNOWN = 5;
export const STATES = [SEEN, EXTRA, HIDDEN, OUTSIDE, LOST] as const;

/** What each state is called, in the order of their numbers; colours have the same names. */
export const STATE_NAMES = ['outside', 'hidden', 'seen', 'extra', 'lost', 'unknown'];
const STATE_MEANINGS = [
  'outside the view, not drawn',
  'in the view but culled as hidden',
  'drawn and really seen',
  'drawn although nothing of it is seen',
  'seen but not drawn: an error',
  'no state stored',
];

/** The words for a state. Without the truth nobody knows whether what was drawn is seen, so the words must not say so. */
export function state_words(state: number, checked: boolean): { name: string; meaning: string } {
  if (!checked && state === SEEN) return { name: 'drawn', meaning: 'drawn; not checked whether it is seen' };
  if (!checked && state === HIDDEN) return { name: 'culled', meaning: 'in the view but culled; not checked' };
  return { name: STATE_NAMES[state] ?? 'unknown', meaning: STATE_MEANINGS[state] ?? 'no state stored' };
}

export function decode_bytes(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** Camera of a stored frame with its eye, in world space. */
export interface Camera extends StoredFrame {
  eye: Vector;
}

export class Walk {
  readonly runs: Run[];
  readonly size: [number, number] | null;
  readonly samples: number;  // of the truth, per axis of a pixel
  readonly scene_name: string;
  readonly scene_path: string;
  readonly triangles: number | null;
  readonly object_count: number;
  readonly bounds: Float32Array | null;  // per object lo xyz, hi xyz, world space
  readonly command: string;
  readonly version: string;
  readonly date: string;
  readonly pictures: Picture[];
  readonly comparison: Comparison | null;
  readonly complaints: string[] = [];  // what is wrong with the data, in sentences
  private readonly stored: StoredFrame[][];  // per run, by frame
  private readonly with_states: StoredFrame[][];
  private readonly decoded = new Map<StoredFrame, Uint8Array>();

  constructor(raw: RawWalk) {
    const frames = raw.frames ?? [];
    const runs = raw.runs ?? [{ method: raw.method ?? 'unnamed method', promise: raw.promise, frames, summary: raw.summary ?? {} }];
    this.runs = runs.map((run) => ({ ...run, frames: run.frames ?? [], summary: run.summary ?? {} }));
    this.size = raw.size ?? null;
    this.samples = raw.samples ?? 1;
    this.scene_path = raw.scene?.name ?? 'unnamed scene';
    this.scene_name = this.scene_path.replace(/^.*[\\/](?=.)/, '');
    this.triangles = raw.scene?.triangles ?? null;
    const report = raw.report ?? {};
    this.command = report.command ?? '';
    this.version = report.version ?? '';
    this.date = (report.date ?? '').replace(/^(\d{4}-\d\d-\d\d)T(\d\d:\d\d).*Z$/, '$1 $2 UTC');
    this.pictures = (report.pictures ?? []).filter((picture) => picture.png);
    this.comparison = report.comparison ?? null;
    this.bounds = this.read_bounds(report.objects?.bounds);
    this.object_count = raw.scene?.objects ?? (this.bounds ? this.bounds.length / 6 : 0);
    this.stored = this.runs.map((run, index) => this.stored_of(run, index, report.frames ?? []));
    this.with_states = this.stored.map((stored) => (this.bounds ? stored.filter((frame) => frame.state) : []));
    if (this.runs.some((run) => run.summary.interrupted))
      this.complaints.push(`The walk was interrupted after ${this.frame_count} frames.`);
    if (raw.schema && raw.schema !== 'sightline.walk/1')
      this.complaints.push(`This page was made for sightline.walk/1, but the data says ${raw.schema}.`);
  }

  get frame_count(): number {
    return this.runs.reduce((count, run) => Math.max(count, run.frames.length), 0);
  }

  frame(run: number, index: number): WalkFrame | undefined {
    return this.runs[run]?.frames[index];
  }

  /** Whether a frame was compared with the truth. */
  checked(run: number, index: number): boolean {
    return typeof this.frame(run, index)?.truth === 'number';
  }

  has_states(run: number): boolean {
    return this.with_states[run].length > 0;
  }

  /** Frames of a run that have states, in order. */
  state_frames(run: number): StoredFrame[] {
    return this.with_states[run];
  }

  /** The stored camera nearest to a frame of the walk, with its eye; null if none is stored. */
  camera(run: number, index: number): Camera | null {
    return this.nearest(run, this.stored[run], index);
  }

  /** The same among frames that have states: whose colours are shown. Without any states the nearest camera. */
  state_camera(run: number, index: number): Camera | null {
    return this.nearest(run, this.with_states[run], index) ?? this.camera(run, index);
  }

  /** States of all objects in a stored frame; null if it has none. */
  states(run: number, stored_index: number): Uint8Array | null {
    const frame = this.with_states[run].find((candidate) => candidate.frame === stored_index);
    if (!frame?.state || !this.bounds) return null;
    let states = this.decoded.get(frame);
    if (!states) {
      states = decode_bytes(frame.state);
      if (this.decoded.size > 64) this.decoded.clear();
      this.decoded.set(frame, states);
    }
    return states;
  }

  /** Every eye of a run, in order; the frames of all runs follow the same path. */
  eyes(run: number): Vector[] {
    return this.runs[run].frames.map((frame) => frame.eye).filter((eye) => eye?.length === 3);
  }

  private nearest(run: number, frames: StoredFrame[], index: number): Camera | null {
    if (frames.length === 0) return null;
    let low = 0, high = frames.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (frames[middle].frame < index) low = middle + 1;
      else high = middle;
    }
    const before = frames[Math.max(0, low - 1)], after = frames[low];
    const nearest = index - before.frame < after.frame - index ? before : after;
    const eye = this.frame(run, nearest.frame)?.eye;
    return eye ? { ...nearest, eye } : null;
  }

  private read_bounds(base64: string | undefined): Float32Array | null {
    if (!base64) return null;
    const bytes = decode_bytes(base64);
    if (bytes.length === 0 || bytes.length % 24 !== 0) {
      this.complaints.push(`The bounds of the objects are ${bytes.length} bytes long, which is not a multiple of 24.`);
      return null;
    }
    return new Float32Array(bytes.buffer);
  }

  /** The cameras of the first method serve a method without states too, since all walk the same way. */
  private stored_cameras(frames: StoredFrame[]): StoredFrame[] {
    const first = frames.filter((frame) => frame.method === undefined || frame.method === this.runs[0].method);
    return first.map((frame) => ({ ...frame, state: null })).sort((a, b) => a.frame - b.frame);
  }

  private stored_of(run: Run, index: number, frames: StoredFrame[]): StoredFrame[] {
    const mine = frames.filter((frame) => (frame.method === undefined ? index === 0 : frame.method === run.method));
    const objects = this.bounds ? this.bounds.length / 6 : 0;
    const fitting = mine.filter((frame) => {
      if (!frame.state || !this.bounds) return true;
      const length = (frame.state.length / 4) * 3 - (frame.state.endsWith('==') ? 2 : frame.state.endsWith('=') ? 1 : 0);
      return length === objects;
    });
    if (fitting.length < mine.length)
      this.complaints.push(`${mine.length - fitting.length} of the stored frames are left out: their states do not fit ${objects} objects.`);
    if (fitting.length === 0 && index > 0) return this.stored_cameras(frames);
    return fitting.sort((a, b) => a.frame - b.frame);
  }
}
