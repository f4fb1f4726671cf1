// The camera of the 3-D view: free orbit, or bound to the walk (behind the eye, or in it), and smooth flights between.
import { PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Camera, Vector } from './data.ts';
import { calm } from './dom.ts';
import type { Placement } from './placement.ts';

export type Mode = 'overview' | 'top' | 'follow' | 'eye' | 'free';

interface Pose {
  position: Vector3;
  target: Vector3;
  fov: number;
}

const FLIGHT_MS = 900;
const FOV = 45;

const vector = (value: Vector) => new Vector3(...value);

export class Flight {
  readonly camera = new PerspectiveCamera(FOV, 1, 0.1, 1000);
  readonly controls: OrbitControls;
  mode: Mode = 'overview';
  /** How far behind the eye to follow: some objects' lengths, in a small world less. */
  readonly follow_distance: number;
  private readonly outlook: Vector3;  // from where the overview looks
  private flight: { from: Pose; to: Pose; start: number } | null = null;

  /** `view` is what the overview looks along with at first, `wake` asks for a drawing, `taken` says that somebody took the camera by hand. */
  constructor(canvas: HTMLElement, private readonly place: Placement, view: Camera | null, private readonly wake: () => void, taken: () => void) {
    this.follow_distance = Math.min(0.2 * place.radius, 8 * place.grain);
    const along = view ? flat(view.direction) : new Vector3(-0.55, 0, -0.83);
    this.outlook = along.clone().negate().addScaledVector(new Vector3(-along.z, 0, along.x), 0.55).setY(0.92).normalize();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.maxDistance = 12 * place.radius;
    this.controls.addEventListener('change', wake);
    this.controls.addEventListener('start', () => {
      this.flight = null;
      if (this.mode === 'eye') this.camera.fov = FOV;
      this.mode = 'free';
      taken();
      wake();
    });
    this.jump(this.overview());
  }

  /** Changes the mode and flies there; `view` is the camera of the walk, where there is one. */
  go(mode: Mode, view: Camera | null, eye: Vector | null): void {
    this.mode = mode;
    const pose = this.pose(view, eye);
    if (pose) this.fly(pose);
  }

  /** Stays with the walk in the modes that are bound to it. */
  keep_up(view: Camera | null, eye: Vector | null): void {
    if (this.mode !== 'follow' && this.mode !== 'eye') return;
    const pose = this.pose(view, eye);
    if (!pose) return;
    if (this.flight) this.flight.to = pose;
    else this.jump(pose);
    this.wake();
  }

  /** Out of the view, up and back, to where what is seen in it can be overlooked; `reach` is how far that lies. */
  fly_out(view: Camera, reach: number): void {
    const eye = vector(this.place.inward(view.eye));
    const end = this.place.view_corners(view).far.reduce((sum, corner) => sum.add(vector(corner)), new Vector3()).divideScalar(4);
    const length = Math.max(Math.min(eye.distanceTo(end), 1.3 * reach), 2 * this.follow_distance);
    const along = flat(view.direction), aside = new Vector3(-along.z, 0, along.x);
    const target = eye.clone().addScaledVector(vector(view.direction), 0.45 * length);
    const position = target.clone().addScaledVector(along, -0.75 * length).addScaledVector(aside, 0.55 * length);
    position.y += 0.95 * length;
    this.mode = 'free';
    this.fly({ position, target, fov: FOV });
  }

  /** Looks at one object from outside. */
  visit(id: number): void {
    const box = this.place.local.subarray(6 * id, 6 * id + 6);
    const target = new Vector3((box[0] + box[3]) / 2, (box[1] + box[4]) / 2, (box[2] + box[5]) / 2);
    const away = Math.max(Math.hypot(...this.place.size(id)) * 1.6, 0.12 * this.place.radius);
    const from = this.camera.position.clone().sub(target).setY(0).normalize();
    if (from.lengthSq() === 0) from.set(0, 0, 1);
    this.mode = 'free';
    this.fly({ position: target.clone().addScaledVector(from, away).setY(target.y + 0.8 * away), target, fov: FOV });
  }

  resize(aspect: number): void {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.wake();
  }

  /** Advances flights and damping; true while something moves. */
  advance(now: number): boolean {
    let moving = false;
    if (this.flight) {
      const part = Math.min(1, (now - this.flight.start) / FLIGHT_MS);
      const eased = part < 0.5 ? 4 * part ** 3 : 1 - (2 - 2 * part) ** 3 / 2;
      const { from, to } = this.flight;
      this.set({
        position: from.position.clone().lerp(to.position, eased),
        target: from.target.clone().lerp(to.target, eased),
        fov: from.fov + (to.fov - from.fov) * eased,
      });
      if (part === 1) this.flight = null;
      moving = true;
    } else if (this.mode !== 'eye' && this.mode !== 'follow') {
      moving = this.controls.update();
    }
    this.fit_planes();
    return moving;
  }

  private pose(view: Camera | null, eye: Vector | null): Pose | null {
    if (this.mode === 'overview') return this.overview();
    if (this.mode === 'top') return this.from_above();
    if (!view || !eye) return null;
    const at = vector(this.place.inward(eye)), along = vector(view.direction);
    if (this.mode === 'eye') return { position: at, target: at.clone().addScaledVector(along, 0.1 * this.place.radius), fov: this.fitting_fov(view) };
    const back = this.follow_distance, level = flat(view.direction);
    const position = at.clone().addScaledVector(level, -back);
    position.y += 0.9 * back;
    return { position, target: at.clone().addScaledVector(level, 0.5 * back), fov: FOV };
  }

  /** A field of view in which the whole picture of the view fits, in degrees. */
  private fitting_fov(view: Camera): number {
    if (!view.fov_y) return FOV;
    const half = Math.tan(view.fov_y / 2) * Math.max(1, view.aspect / this.camera.aspect);
    return (2 * Math.atan(half) * 180) / Math.PI;
  }

  private overview(): Pose {
    const distance = 1.9 * this.place.radius * Math.max(1, 1.2 / this.camera.aspect);
    return { position: this.outlook.clone().multiplyScalar(distance), target: new Vector3(), fov: FOV };
  }

  private from_above(): Pose {
    const { lo, hi } = this.place.frame;
    const half = Math.max((hi[2] - lo[2]) / 2, (hi[0] - lo[0]) / 2 / this.camera.aspect) * 1.08;
    const height = hi[1] + half / Math.tan((FOV * Math.PI) / 360);
    return { position: new Vector3(0, height, 1e-4 * height), target: new Vector3(), fov: FOV };
  }

  private fly(to: Pose): void {
    if (calm()) this.jump(to);
    else this.flight = { from: { position: this.camera.position.clone(), target: this.controls.target.clone(), fov: this.camera.fov }, to, start: performance.now() };
    this.wake();
  }

  private jump(pose: Pose): void {
    this.flight = null;
    this.set(pose);
  }

  private set(pose: Pose): void {
    this.camera.position.copy(pose.position);
    this.controls.target.copy(pose.target);
    this.camera.fov = pose.fov;
    this.camera.lookAt(pose.target);
    this.camera.updateProjectionMatrix();
  }

  /** Depth planes that suit where the camera is: near to the walk fine steps, far out coarse ones. */
  private fit_planes(): void {
    const distance = this.camera.position.length();
    const inside = distance < 1.2 * this.place.radius;
    this.camera.near = inside ? Math.max(2e-4 * this.place.radius, 0.02 * this.camera.position.distanceTo(this.controls.target) * (this.mode === 'eye' ? 0.05 : 1))
                              : Math.max(1e-3 * this.place.radius, 0.25 * (distance - this.place.radius));
    this.camera.far = distance + 6 * this.place.radius;
    this.camera.updateProjectionMatrix();
  }
}

function flat(direction: Vector): Vector3 {
  const level = new Vector3(direction[0], 0, direction[2]);
  return level.lengthSq() > 1e-6 ? level.normalize() : new Vector3(0, 0, -1);
}
