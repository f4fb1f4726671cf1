// All objects as boxes in one instanced draw call: bounds go to the GPU once, a frame changes one byte per object. Solid
// boxes are shaded with thin edges; the same boxes can be drawn as edges only, or through everything else.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry, LineSegments, Mesh, ShaderMaterial,
  type Object3D,
} from 'three';
import { STATE_NAMES, UNKNOWN } from './data.ts';
import { colour } from './dom.ts';

export type BoxStyle = 'solid' | 'edges' | 'through';

/** What all boxes share; changing a value shows with the next drawing. */
export interface BoxLook {
  palette: { value: Color[] };
  shown: { value: number[] };
  cut: { value: number };      // height, relative to the centre
  haze: { value: Color };      // what distance fades to
  haze_distance: { value: number };
}

export function box_look(): BoxLook {
  return {
    palette: { value: STATE_NAMES.map(() => new Color()) },
    shown: { value: STATE_NAMES.map(() => 1) },
    cut: { value: 1e9 },
    haze: { value: new Color() },
    haze_distance: { value: 1 },
  };
}

export function paint_look(look: BoxLook): void {
  STATE_NAMES.forEach((name, state) => look.palette.value[state].setStyle(colour(`--${name}`)));
  look.haze.value.setStyle(colour('--space'));
}

const VERTEX = `
attribute vec3 lo;
attribute vec3 hi;
attribute float state;
uniform vec3 palette[6];
uniform float shown[6];
uniform float cut;
varying vec3 tint;
varying vec3 side;
varying vec3 place;
varying float away;
void main() {
  int number = int(state + 0.5);
  tint = palette[number];
  vec3 top = vec3(hi.x, min(hi.y, cut), hi.z);
  vec4 seen = modelViewMatrix * vec4(mix(lo, top, position), 1.0);
  side = normal;
  place = position;
  away = -seen.z;
  gl_Position = projectionMatrix * seen;
  if (shown[number] < 0.5 || !(lo.y < cut)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const FRAGMENT = `
uniform vec3 haze;
uniform float haze_distance;
uniform float strength;
varying vec3 tint;
varying vec3 side;
varying vec3 place;
varying float away;
float edge() {
  vec3 width = fwidth(place);
  vec3 within = min(place, 1.0 - place) / max(width, vec3(1e-6));
  within = mix(within, vec3(1e3), step(0.5, abs(side)));
  vec3 small = mix(width, vec3(0.0), step(0.5, abs(side)));
  float line = 1.0 - smoothstep(0.6, 1.5, min(within.x, min(within.y, within.z)));
  return line * (1.0 - smoothstep(0.08, 0.3, max(small.x, max(small.y, small.z))));
}
void main() {
  vec3 colour = tint;
#ifdef SHADED
  float light = 0.86 + 0.14 * side.y + 0.09 * side.x - 0.05 * abs(side.z);
  colour = tint * light;
  colour = mix(colour, colour * 0.55, edge() * 0.75);
#endif
  float fade = 1.0 - exp(-away / haze_distance);
  colour = mix(colour, haze, clamp(fade, 0.0, 1.0) * 0.6);
  gl_FragColor = vec4(colour, strength);
  #include <colorspace_fragment>
}`;

const CORNERS = [0, 1].flatMap((x) => [0, 1].flatMap((y) => [0, 1].map((z) => [x, y, z])));

/** The unit cube as 12 triangles with normals. */
function cube(): { position: Float32Array; normal: Float32Array } {
  const position: number[] = [], normal: number[] = [];
  for (let axis = 0; axis < 3; ++axis)
    for (const end of [0, 1]) {
      const u = (axis + 1) % 3, v = (axis + 2) % 3;
      const square = end ? [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]] : [[0, 0], [1, 1], [1, 0], [0, 0], [0, 1], [1, 1]];
      for (const [a, b] of square) {
        const corner = [0, 0, 0], out = [0, 0, 0];
        corner[axis] = end;
        corner[u] = a;
        corner[v] = b;
        out[axis] = end ? 1 : -1;
        position.push(...corner);
        normal.push(...out);
      }
    }
  return { position: new Float32Array(position), normal: new Float32Array(normal) };
}

/** The twelve edges of the unit cube. */
function cube_edges(): { position: Float32Array; normal: Float32Array } {
  const position: number[] = [];
  for (const a of CORNERS)
    for (const b of CORNERS)
      if (a.filter((value, axis) => value !== b[axis]).length === 1 && a < b) position.push(...a, ...b);
  return { position: new Float32Array(position), normal: new Float32Array(position.length) };
}

function material(style: BoxStyle, look: BoxLook): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: { ...look, strength: { value: style === 'through' ? 0.75 : style === 'edges' ? 0.9 : 1 } } as never,
    defines: style === 'solid' ? { SHADED: '' } : {},
    transparent: style === 'through',
    depthTest: style !== 'through',
    depthWrite: style !== 'through',
    side: DoubleSide,
  });
}

export class Boxes {
  readonly object: Object3D;
  private readonly state: InstancedBufferAttribute;
  private readonly geometry: InstancedBufferGeometry;

  /** `ids` are the objects to draw out of `bounds` (per object lo and hi). */
  constructor(bounds: Float32Array, private readonly ids: Uint32Array, style: BoxStyle, look: BoxLook) {
    const lo = new Float32Array(3 * ids.length), hi = new Float32Array(3 * ids.length);
    ids.forEach((id, index) => {
      lo.set(bounds.subarray(6 * id, 6 * id + 3), 3 * index);
      hi.set(bounds.subarray(6 * id + 3, 6 * id + 6), 3 * index);
    });
    const shape = style === 'solid' ? cube() : cube_edges();
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(shape.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(shape.normal, 3));
    geometry.setAttribute('lo', new InstancedBufferAttribute(lo, 3));
    geometry.setAttribute('hi', new InstancedBufferAttribute(hi, 3));
    this.state = new InstancedBufferAttribute(new Uint8Array(ids.length).fill(UNKNOWN), 1);
    geometry.setAttribute('state', this.state);
    geometry.instanceCount = ids.length;
    this.geometry = geometry;
    const made = style === 'solid' ? new Mesh(geometry as BufferGeometry, material(style, look))
                                   : new LineSegments(geometry as BufferGeometry, material(style, look));
    made.frustumCulled = false;
    made.renderOrder = style === 'through' ? 3 : 0;
    this.object = made;
  }

  /** States of all objects by id; null where none are stored. */
  show_states(states: Uint8Array | null): void {
    const own = this.state.array as Uint8Array;
    for (let index = 0; index < own.length; ++index) own[index] = states ? Math.min(states[this.ids[index]], UNKNOWN) : UNKNOWN;
    this.state.needsUpdate = true;
  }

  dispose(): void {
    this.geometry.dispose();
    ((this.object as Mesh).material as ShaderMaterial).dispose();
  }
}
