// All objects as boxes in one instanced draw call: bounds go to the GPU once, a frame changes one byte per object. Solid
// boxes are shaded with thin edges, only the three faces towards the camera are drawn; the same boxes can be drawn as
// edges only, or through everything else.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry, LineSegments, Mesh, ShaderMaterial,
  type Object3D,
} from 'three';
import { STATE_NAMES, UNKNOWN } from './data.ts';
import { colour } from './dom.ts';

export type BoxStyle = 'solid' | 'edges' | 'through';

/** What boxes share: how they look, and one material per style. Changing a value shows with the next drawing. */
export class BoxMaterials {
  readonly palette = { value: STATE_NAMES.map(() => new Color()) };
  readonly shown = { value: STATE_NAMES.map(() => 1) };
  readonly cut = { value: 1e9 };            // height, relative to the centre
  readonly haze = { value: new Color() };   // what distance fades to
  readonly haze_distance = { value: 1e9 };
  readonly haze_share = { value: 0 };       // of the haze at the far end, 0 to 1
  private readonly made = new Map<BoxStyle, ShaderMaterial>();

  of(style: BoxStyle): ShaderMaterial {
    const known = this.made.get(style) ?? this.make(style);
    this.made.set(style, known);
    return known;
  }

  /** Takes the colours of the page's scheme, or one for all. */
  paint(single?: string): void {
    STATE_NAMES.forEach((name, state) => this.palette.value[state].setStyle(colour(single ?? `--${name}`)));
    this.haze.value.setStyle(colour('--space'));
  }

  private make(style: BoxStyle): ShaderMaterial {
    const { palette, shown, cut, haze, haze_distance, haze_share } = this;
    return new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { palette, shown, cut, haze, haze_distance, haze_share, strength: { value: style === 'through' ? 0.75 : 1 } },
      defines: style === 'solid' ? { SHADED: '' } : {},
      transparent: style === 'through',
      depthTest: style !== 'through',
      depthWrite: style !== 'through',
      side: DoubleSide,
    });
  }
}

const VERTEX = `
attribute vec3 lo;
attribute vec3 hi;
attribute float state;
uniform vec3 palette[6];
uniform float shown[6];
uniform float cut;
flat varying vec3 tint;
flat varying vec3 side;
varying vec3 place;
varying float away;
void main() {
  int number = int(state + 0.5);
  tint = palette[number];
  vec3 top = vec3(hi.x, min(hi.y, cut), hi.z);
  place = position;
  side = normal;
#ifdef SHADED
  vec3 towards = step(0.5 * (lo + top), cameraPosition);
  place = mix(1.0 - position, position, towards);
  side = normal * (2.0 * towards - 1.0);
#endif
  vec4 seen = modelViewMatrix * vec4(mix(lo, top, place), 1.0);
  away = -seen.z;
  gl_Position = projectionMatrix * seen;
  if (shown[number] < 0.5 || !(lo.y < cut)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const FRAGMENT = `
uniform vec3 haze;
uniform float haze_distance;
uniform float haze_share;
uniform float strength;
flat varying vec3 tint;
flat varying vec3 side;
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
  float light = 0.82 + 0.2 * side.y + 0.1 * side.x - 0.1 * abs(side.z) + 0.04 * side.z;
  colour = tint * light;
  colour = mix(colour, colour * 0.55, edge() * 0.75);
#endif
  float fade = 1.0 - exp(-away / haze_distance);
  colour = mix(colour, haze, clamp(fade, 0.0, 1.0) * haze_share);
  gl_FragColor = vec4(colour, strength);
  #include <colorspace_fragment>
}`;

const CORNERS = [0, 1].flatMap((x) => [0, 1].flatMap((y) => [0, 1].map((z) => [x, y, z])));

interface Shape {
  position: Float32Array;
  normal: Float32Array;
  index: number[] | null;
}

/** Three faces of the unit cube; the vertex shader turns them to the side from which a box is seen. */
function half_cube(): Shape {
  const position: number[] = [], normal: number[] = [], index: number[] = [];
  for (let axis = 0; axis < 3; ++axis) {
    index.push(...[0, 1, 2, 0, 2, 3].map((corner) => corner + 4 * axis));
    for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
      const corner = [0, 0, 0], out = [0, 0, 0];
      corner[axis] = out[axis] = 1;
      corner[(axis + 1) % 3] = a;
      corner[(axis + 2) % 3] = b;
      position.push(...corner);
      normal.push(...out);
    }
  }
  return { position: new Float32Array(position), normal: new Float32Array(normal), index };
}

/** The twelve edges of the unit cube. */
function cube_edges(): Shape {
  const position: number[] = [];
  for (const a of CORNERS)
    for (const b of CORNERS)
      if (a.filter((value, axis) => value !== b[axis]).length === 1 && a < b) position.push(...a, ...b);
  return { position: new Float32Array(position), normal: new Float32Array(position.length), index: null };
}

export class Boxes {
  readonly object: Object3D;
  private readonly state: InstancedBufferAttribute;
  private readonly geometry: InstancedBufferGeometry;

  /** `ids` are the objects to draw out of `bounds` (per object lo and hi). */
  constructor(bounds: Float32Array, private readonly ids: Uint32Array, style: BoxStyle, look: BoxMaterials) {
    const lo = new Float32Array(3 * ids.length), hi = new Float32Array(3 * ids.length);
    ids.forEach((id, index) => {
      lo.set(bounds.subarray(6 * id, 6 * id + 3), 3 * index);
      hi.set(bounds.subarray(6 * id + 3, 6 * id + 6), 3 * index);
    });
    const shape = style === 'solid' ? half_cube() : cube_edges();
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(shape.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(shape.normal, 3));
    if (shape.index) geometry.setIndex(shape.index);
    geometry.setAttribute('lo', new InstancedBufferAttribute(lo, 3));
    geometry.setAttribute('hi', new InstancedBufferAttribute(hi, 3));
    this.state = new InstancedBufferAttribute(new Uint8Array(ids.length).fill(UNKNOWN), 1);
    geometry.setAttribute('state', this.state);
    geometry.instanceCount = ids.length;
    this.geometry = geometry;
    const made = style === 'solid' ? new Mesh(geometry as BufferGeometry, look.of(style))
                                   : new LineSegments(geometry as BufferGeometry, look.of(style));
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
  }
}
