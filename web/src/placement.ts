// Where things are: object bounds around a common centre (so that single precision is enough far from the origin), the
// part of the world worth framing, objects that enclose the walk and are drawn as edges only, and the height of a roof.
import type { Camera, Vector, Walk } from './data.ts';
import { median } from './figures.ts';

export interface Box {
  lo: Vector;
  hi: Vector;
}

const ENCLOSING_SHARE = 0.35;  // of the framed width and depth, from which on a box is drawn as edges only

export class Placement {
  readonly count: number;
  readonly centre: Vector;
  readonly local: Float32Array;   // per object lo, hi, relative to the centre
  readonly eyes: Vector[];        // relative to the centre
  readonly frame: Box;            // what to frame, relative to the centre; far outliers may lie outside
  readonly radius: number;
  readonly grain: number;         // diagonal of a typical object
  readonly enclosing: Uint8Array; // 1 for objects drawn as edges only
  readonly roof: number | null;   // height between the eyes and a ceiling above most of them; null if there is none

  constructor(walk: Walk) {
    const world = walk.bounds ?? new Float32Array(0);
    const eyes = walk.eyes(0);
    this.count = world.length / 6;
    const frame = framing(world, eyes);
    this.centre = [0, 1, 2].map((axis) => (frame.lo[axis] + frame.hi[axis]) / 2) as Vector;
    this.local = new Float32Array(world.length);
    for (let i = 0; i < world.length; ++i) this.local[i] = world[i] - this.centre[i % 3];
    for (let id = 0; id < this.count; ++id)
      if (!is_box(world, id)) this.local.fill(NaN, 6 * id, 6 * id + 6);
    this.eyes = eyes.map((eye) => this.inward(eye));
    this.frame = { lo: this.inward(frame.lo), hi: this.inward(frame.hi) };
    this.radius = Math.max(1e-3, Math.hypot(...this.frame.hi));
    this.grain = this.find_grain();
    this.enclosing = this.find_enclosing();
    this.roof = this.find_roof();
  }

  /** From world space to the space around the centre. */
  inward(point: Vector): Vector {
    return [point[0] - this.centre[0], point[1] - this.centre[1], point[2] - this.centre[2]];
  }

  size(id: number): Vector {
    const box = this.local.subarray(6 * id, 6 * id + 6);
    return [box[3] - box[0], box[4] - box[1], box[5] - box[2]];
  }

  /** The four near and the four far corners of a view, cut where the framed world ends; relative to the centre. The near
   *  ones of a perspective view all are its eye. */
  view_corners(camera: Camera): { near: Vector[]; far: Vector[] } {
    const eye = this.inward(camera.eye);
    const depth = Math.min(camera.far ?? Infinity, this.reach(eye, camera.direction));
    const at = (distance: number) => {
      const half_y = camera.fov_y ? Math.tan(camera.fov_y / 2) * distance : (camera.span_y ?? 0) / 2, half_x = half_y * camera.aspect;
      return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [0, 1, 2].map((axis) =>
        eye[axis] + camera.direction[axis] * distance + camera.right[axis] * half_x * x + camera.up[axis] * half_y * y) as Vector);
    };
    return { near: at(camera.fov_y ? 0 : Math.min(camera.near, depth)), far: at(depth) };
  }

  /** The faces of that solid, cut to the framed world and to a height, so that they show where the view runs in it. */
  view_faces(camera: Camera, height = Infinity): Vector[][] {
    const { near, far } = this.view_corners(camera);
    const sides = [0, 1, 2, 3].map((i) => [near[i], ...(camera.fov_y ? [] : [near[(i + 1) % 4]]), far[(i + 1) % 4], far[i]]);
    let faces = [...sides, far, ...(camera.fov_y ? [] : [near])];
    const eye = this.inward(camera.eye), slack = 0.03 * this.radius;
    for (let axis = 0; axis < 3; ++axis) {
      const top = axis === 1 ? Math.min(this.frame.hi[1], height) : this.frame.hi[axis];
      const least = Math.min(this.frame.lo[axis], eye[axis]) - slack, most = Math.max(top, eye[axis]) + slack;
      faces = clip_solid(clip_solid(faces, axis, 1, most), axis, -1, -least);
    }
    return faces;
  }

  /** How far the framed world goes on from an eye along a direction, at least a tenth of its radius. */
  private reach(eye: Vector, direction: Vector): number {
    let far = 0.1 * this.radius;
    for (let corner = 0; corner < 8; ++corner) {
      let along = 0;
      for (let axis = 0; axis < 3; ++axis)
        along += ((corner >> axis & 1 ? this.frame.hi : this.frame.lo)[axis] - eye[axis]) * direction[axis];
      far = Math.max(far, along);
    }
    return far;
  }

  private find_grain(): number {
    const diagonals = Array.from({ length: this.count }, (_, id) => Math.hypot(...this.size(id))).filter((length) => length > 0);
    return median(diagonals) ?? this.radius;
  }

  private find_enclosing(): Uint8Array {
    const flags = new Uint8Array(this.count);
    const wide = ENCLOSING_SHARE * (this.frame.hi[0] - this.frame.lo[0]);
    const deep = ENCLOSING_SHARE * (this.frame.hi[2] - this.frame.lo[2]);
    const eyes = sample(this.eyes, 40);
    for (let id = 0; id < this.count; ++id) {
      const [x, , z] = this.size(id);
      let inside = 0;
      for (const eye of eyes) if (this.covers(id, eye) && this.local[6 * id + 1] < eye[1] && this.local[6 * id + 4] > eye[1]) ++inside;
      if ((x > wide && z > deep) || inside > 0.3 * eyes.length) flags[id] = 1;
    }
    return flags;
  }

  private covers(id: number, eye: Vector): boolean {
    const at = 6 * id, box = this.local;
    return box[at] < eye[0] && box[at + 3] > eye[0] && box[at + 2] < eye[2] && box[at + 5] > eye[2];
  }

  private find_roof(): number | null {
    const eyes = sample(this.eyes, 40);
    const gaps: number[] = [];
    for (const eye of eyes) {
      let gap = Infinity;
      for (let id = 0; id < this.count; ++id)
        if (this.local[6 * id + 1] > eye[1] && this.covers(id, eye)) gap = Math.min(gap, this.local[6 * id + 1] - eye[1]);
      if (gap < Infinity) gaps.push(gap);
    }
    if (gaps.length < 0.5 * eyes.length || gaps.length === 0) return null;
    gaps.sort((a, b) => a - b);
    const heights = this.eyes.map((eye) => eye[1]).sort((a, b) => a - b);
    return heights[heights.length - 1] + 0.4 * gaps[gaps.length >> 1];
  }
}

/** The part of a convex solid where sign times a coordinate is at most a limit, with the face that the cut makes. */
function clip_solid(faces: Vector[][], axis: number, sign: number, limit: number): Vector[][] {
  const kept = faces.map((face) => clip(face, axis, sign, limit)).filter((face) => face.length > 2);
  if (faces.every((face) => face.every((point) => sign * point[axis] <= limit))) return faces;
  const near = 1e-9 * Math.max(1, Math.abs(limit)), u = (axis + 1) % 3, v = (axis + 2) % 3;
  const rim = kept.flat().filter((point) => Math.abs(sign * point[axis] - limit) <= near);
  const middle = (along: number) => rim.reduce((sum, point) => sum + point[along], 0) / rim.length;
  const centre = [middle(u), middle(v)];
  const cap = rim.sort((a, b) => Math.atan2(a[v] - centre[1], a[u] - centre[0]) - Math.atan2(b[v] - centre[1], b[u] - centre[0]));
  return cap.length > 2 ? [...kept, cap] : kept;
}

/** The part of a polygon where sign times a coordinate is at most a limit (Sutherland and Hodgman 1974, one plane). */
function clip(polygon: Vector[], axis: number, sign: number, limit: number): Vector[] {
  return polygon.flatMap((from, index) => {
    const to = polygon[(index + 1) % polygon.length];
    const start = sign * from[axis], end = sign * to[axis];
    const kept = start <= limit ? [from] : [];
    if (start <= limit === end <= limit) return kept;
    const part = (limit - start) / (end - start);
    return [...kept, from.map((value, i) => value + part * (to[i] - value)) as Vector];
  });
}

function sample<T>(all: T[], most: number): T[] {
  if (all.length <= most) return all;
  return Array.from({ length: most }, (_, index) => all[Math.floor((index * all.length) / most)]);
}

/** Objects without geometry have no finite bounds; they are not drawn. */
function is_box(world: Float32Array, id: number): boolean {
  const size = [0, 1, 2].map((axis) => world[6 * id + 3 + axis] - world[6 * id + axis]);
  return size.every((length) => length >= 0 && length < Infinity);
}

/** The box that holds all but the outermost hundredth of the objects on each side, and the whole path. */
function framing(world: Float32Array, eyes: Vector[]): Box {
  const box: Box = { lo: [Infinity, Infinity, Infinity], hi: [-Infinity, -Infinity, -Infinity] };
  const valid = Array.from({ length: world.length / 6 }, (_, id) => id).filter((id) => is_box(world, id));
  const count = valid.length;
  for (let axis = 0; axis < 3; ++axis) {
    const lows = new Float32Array(count), highs = new Float32Array(count);
    valid.forEach((id, index) => {
      lows[index] = world[6 * id + axis];
      highs[index] = world[6 * id + 3 + axis];
    });
    lows.sort();
    highs.sort();
    const cut = count > 50 ? Math.ceil(0.01 * count) : 0;
    if (count > 0) {
      box.lo[axis] = lows[cut];
      box.hi[axis] = highs[count - 1 - cut];
    }
    for (const eye of eyes) {
      box.lo[axis] = Math.min(box.lo[axis], eye[axis]);
      box.hi[axis] = Math.max(box.hi[axis], eye[axis]);
    }
    if (!(box.lo[axis] <= box.hi[axis])) box.lo[axis] = box.hi[axis] = 0;
  }
  return box;
}

/** The object that a ray meets first among those drawn; enclosing ones do not count. -1 if there is none. */
export function pick(place: Placement, origin: Vector, direction: Vector, drawn: (id: number) => boolean, cut: number): number {
  const inverse = direction.map((value) => 1 / value);
  let nearest = Infinity, found = -1;
  for (let id = 0; id < place.count; ++id) {
    let enter = 0, leave = nearest;
    for (let axis = 0; axis < 3 && enter <= leave; ++axis) {
      const lo = place.local[6 * id + axis], hi = place.local[6 * id + 3 + axis];
      const top = axis === 1 ? Math.min(hi, cut) : hi;
      const a = (lo - origin[axis]) * inverse[axis], b = (top - origin[axis]) * inverse[axis];
      enter = Math.max(enter, Math.min(a, b));
      leave = Math.min(leave, Math.max(a, b));
    }
    if (enter > leave || enter === 0 || place.enclosing[id] || place.local[6 * id + 1] >= cut || !drawn(id)) continue;
    nearest = enter;
    found = id;
  }
  return found;
}
