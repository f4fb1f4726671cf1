// The 3-D panel: every object as a box in the colour of its state, the way of the eye, the view of the frame; cameras to
// fly with and the freeze that lets one look at a culled view from outside. Draws only when something changed.
import { Raycaster, Scene, Vector2, WebGLRenderer, Color, type Object3D } from 'three';
import { BoxMaterials, Boxes } from './boxes.ts';
import { LOST, SEEN, STATE_NAMES, UNKNOWN, type Camera, type Vector, type Walk } from './data.ts';
import { choice, colour, element } from './dom.ts';
import { Flight, type Mode } from './flight.ts';
import { metres } from './format.ts';
import { eye_ball, free, ground, path_line, view_lines } from './lines.ts';
import { pick, type Placement } from './placement.ts';
import type { Store } from './store.ts';
import { describe_object, Tooltip } from './tooltip.ts';

/** Where following the eye takes less than this share of the world, an overview shows only dots. */
const SMALL_WALK = 0.05;

/** More objects than this crawl where the processor draws instead of a graphics card. */
const MOST_IN_SOFTWARE = 60_000;

export type SpacePanel = { panel: HTMLElement } | { missing: 'no WebGL' | 'too slow' };

/** The panel, or why there is none; `anyway` shows it even if it will be slow. */
export function space_view(walk: Walk, place: Placement, store: Store, anyway = false): SpacePanel {
  const canvas = element('canvas', { tabindex: 0, 'aria-label': '3-D view of the objects, coloured by state. Drag to turn, click and scroll to zoom.' });
  const context = canvas.getContext('webgl2', { antialias: true });
  if (!context) return { missing: 'no WebGL' };
  if (!anyway && place.count > MOST_IN_SOFTWARE && in_software(context)) return { missing: 'too slow' };
  const renderer = new WebGLRenderer({ canvas, context, antialias: true });
  return { panel: new SpaceView(walk, place, store, canvas, renderer).root };
}

function in_software(context: WebGL2RenderingContext): boolean {
  const names = context.getExtension('WEBGL_debug_renderer_info');
  const name = context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(String(name));
}

class SpaceView {
  readonly root: HTMLElement;
  private readonly scene = new Scene();
  private readonly look = new BoxMaterials();
  private readonly outline_look = new BoxMaterials();
  private readonly flight: Flight;
  private readonly boxes: Boxes[];
  private readonly image_edge = element('div', { class: 'image-edge', hidden: true, 'aria-hidden': 'true' });
  private readonly scale = element('span', { class: 'scale' });
  private readonly banner = element('div', { class: 'banner', hidden: true, role: 'status' });
  private readonly cameras: ReturnType<typeof choice<Mode>>;
  private readonly tooltip = new Tooltip();
  private lost: Boxes | null = null;
  private outlined: Boxes | null = null;
  private lines: Object3D[] = [];
  private view_lines: Object3D[] = [];
  private waiting = false;

  constructor(private readonly walk: Walk, private readonly place: Placement, private readonly store: Store,
              private readonly canvas: HTMLCanvasElement, private readonly renderer: WebGLRenderer) {
    this.flight = new Flight(canvas, place, this.current(), () => this.wake(), () => this.cameras.show(null));
    this.boxes = this.make_boxes();
    for (const boxes of this.boxes) this.scene.add(boxes.object);
    this.cameras = choice<Mode>('Camera', [
      { value: 'overview', text: 'Overview' },
      { value: 'top', text: 'Top view' },
      { value: 'follow', text: 'Follow camera', title: 'Stay behind the eye while the walk goes on' },
      { value: 'eye', text: 'Through the eye', title: 'See what the camera of the walk sees' },
    ], 'overview', (mode) => this.go(mode));
    this.root = this.lay_out();
    this.listen();
    if (this.flight.follow_distance < SMALL_WALK * place.radius && this.current()) {
      this.cameras.show('follow');
      this.flight.mode = 'follow';
    }
  }

  private make_boxes(): Boxes[] {
    const solid: number[] = [], enclosing: number[] = [];
    for (let id = 0; id < this.place.count; ++id)
      if (!Number.isNaN(this.place.local[6 * id])) (this.place.enclosing[id] ? enclosing : solid).push(id);
    return [new Boxes(this.place.local, Uint32Array.from(solid), 'solid', this.look),
            new Boxes(this.place.local, Uint32Array.from(enclosing), 'edges', this.look)];
  }

  private lay_out(): HTMLElement {
    const freeze = element('button', { type: 'button', class: 'freeze', 'aria-pressed': false, onclick: () => this.toggle_freeze() }, 'Freeze culling and fly out');
    this.store.on(['frozen'], () => {
      const frozen = this.store.get('frozen');
      freeze.setAttribute('aria-pressed', String(frozen !== null));
      freeze.textContent = frozen === null ? 'Freeze culling and fly out' : 'Unfreeze';
      this.banner.hidden = frozen === null;
      if (frozen !== null) this.banner.textContent =
        `Culling frozen at frame ${this.walk.frame(this.store.get('run'), frozen)?.frame ?? frozen}. Turn, zoom or scrub on: the colours stay.`;
    });
    freeze.disabled = !this.walk.has_states(0);
    const view = this.walk.camera(0, 0);
    for (const mode of ['follow', 'eye'])
      this.cameras.button(mode as Mode).disabled = !view || (mode === 'eye' && !view.fov_y);
    const stage = element('div', { class: 'stage' }, this.canvas, this.image_edge, this.banner, this.scale, this.tooltip.root);
    return element('div', { class: 'panel space' }, element('div', { class: 'bar' }, this.cameras.root, freeze), stage);
  }

  private listen(): void {
    const { store } = this;
    store.on(['theme'], () => this.paint());
    store.on(['shown', 'cut', 'theme'], () => {
      this.look.shown.value = store.get('shown').map(Number);
      this.place_cut();
      this.show_lines();
      this.wake();
    });
    store.on(['frame', 'frozen', 'run', 'theme'], () => this.show_frame());
    store.on(['selected', 'theme'], () => this.outline());
    store.on(['selected'], () => {
      const id = store.get('selected');
      if (id !== null && this.root.isConnected) this.take(() => this.flight.visit(id));
    });
    new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement as HTMLElement);
    this.canvas.addEventListener('pointermove', (event) => this.hover(event));
    this.canvas.addEventListener('pointerleave', () => { this.tooltip.hide(); this.canvas.blur(); });
    this.canvas.addEventListener('pointerdown', () => this.canvas.focus({ preventScroll: true }));
    // The wheel scrolls the page until the view has been clicked, so that nobody gets stuck in it.
    this.canvas.addEventListener('wheel', (event) => {
      this.flight.controls.enableZoom = document.activeElement === this.canvas || event.ctrlKey;
    }, { capture: true });
    let pressed: [number, number] = [0, 0];
    this.canvas.addEventListener('pointerdown', (event) => { pressed = [event.clientX, event.clientY]; });
    this.canvas.addEventListener('dblclick', (event) => {
      if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
      const id = this.object_under(event);
      store.set({ selected: id >= 0 ? id : null });
    });
  }

  private current(): Camera | null {
    const camera = this.walk.camera(this.store.get('run'), this.store.get('frame'));
    const eye = this.walk.frame(this.store.get('run'), this.store.get('frame'))?.eye;
    return camera && eye ? { ...camera, eye } : camera;
  }

  /** The camera of the states shown. */
  private state_camera(): Camera | null {
    return this.walk.state_camera(this.store.get('run'), this.store.state_frame);
  }

  private go(mode: Mode): void {
    const view = this.current();
    this.flight.go(mode, view, view?.eye ?? null);
    this.place_cut();
    this.frame_image();
    this.show_lines();
    this.wake();
  }

  private toggle_freeze(): void {
    if (this.store.get('frozen') !== null) {
      this.store.set({ frozen: null });
      return;
    }
    this.store.set({ frozen: this.store.get('frame') });
    const view = this.state_camera();
    if (view) this.take(() => this.flight.fly_out(view, this.seen_reach(view)));
  }

  /** How far from an eye what is seen in its frame reaches, but for the last tenth. */
  private seen_reach(view: Camera): number {
    const states = this.states(), eye = this.place.inward(view.eye), box = this.place.local;
    const distances: number[] = [];
    for (let id = 0; states && id < this.place.count; ++id)
      if (states[id] === SEEN && !this.place.enclosing[id])
        distances.push(Math.hypot(...[0, 1, 2].map((axis) => (box[6 * id + axis] + box[6 * id + 3 + axis]) / 2 - eye[axis])));
    return distances.sort((a, b) => a - b)[Math.floor(0.9 * distances.length)] ?? 0.3 * this.place.radius;
  }

  /** Moves the camera out of the modes that are bound to the walk. */
  private take(move: () => void): void {
    move();
    this.cameras.show(null);
    this.place_cut();
    this.frame_image();
    this.show_lines();
  }

  private paint(): void {
    this.look.paint();
    this.outline_look.paint('--ink');
    this.scene.background = new Color(colour('--space'));
    for (const line of this.lines) free(line);
    const grid = ground(this.place.radius, this.place.frame.lo[1]);
    this.scale.textContent = `grid ${metres(grid.userData.cell)}`;
    this.lines = [grid, path_line(this.place.eyes)];
    this.scene.add(...this.lines);
  }

  private show_frame(): void {
    const run = this.store.get('run'), view = this.state_camera();
    const states = view && this.walk.states(run, view.frame);
    for (const boxes of this.boxes) boxes.show_states(states);
    this.show_lost(states);
    this.show_lines();
    const now = this.current();
    this.flight.keep_up(now, now?.eye ?? null);
    this.wake();
  }

  /** Lost objects are outlined through everything in front of them. */
  private show_lost(states: Uint8Array | null): void {
    if (this.lost) { this.lost.object.removeFromParent(); this.lost.dispose(); this.lost = null; }
    const ids: number[] = [];
    if (states) for (let id = 0; id < states.length; ++id) if (states[id] === LOST) ids.push(id);
    if (ids.length === 0) return;
    this.lost = new Boxes(this.place.local, Uint32Array.from(ids), 'through', this.look);
    this.lost.show_states(states);
    this.scene.add(this.lost.object);
  }

  private show_lines(): void {
    for (const line of this.view_lines) free(line);
    this.view_lines = [];
    const through_eye = this.flight.mode === 'eye';
    const bold = this.state_camera(), now = this.current();
    const own = bold?.frame === this.store.get('frame');
    const add = (line: Object3D) => { this.view_lines.push(line); this.scene.add(line); };
    if (bold && !(through_eye && (own || this.store.get('frozen') === null))) add(view_lines(this.place.view_faces(bold, this.look.cut.value), true));
    if (now && !own && !through_eye) add(view_lines(this.place.view_faces(now, this.look.cut.value), false));
    const eye = this.walk.frame(this.store.get('run'), this.store.get('frame'))?.eye;
    if (eye && !through_eye) {
      const ball = eye_ball();
      ball.position.set(...this.place.inward(eye));
      add(ball);
    }
  }

  private outline(): void {
    if (this.outlined) { this.outlined.object.removeFromParent(); this.outlined.dispose(); this.outlined = null; }
    const id = this.store.get('selected');
    if (id === null) return;
    this.outlined = new Boxes(this.place.local, Uint32Array.of(id), 'through', this.outline_look);
    this.scene.add(this.outlined.object);
    this.wake();
  }

  /** Through the eye there is no cut: the picture must be the one of the walk. Haze there tells near from far. */
  private place_cut(): void {
    const cut = this.store.get('cut'), through_eye = this.flight.mode === 'eye';
    this.look.cut.value = through_eye || !Number.isFinite(cut) ? 1e9 : cut - this.place.centre[1];
    this.look.haze_distance.value = (through_eye ? 0.5 : 7) * this.place.radius;
    this.look.haze_share.value = through_eye ? 0.85 : 0.6;
  }

  /** Where the picture of the walk ends, when looking through its eye. */
  private frame_image(): void {
    const view = this.current();
    this.image_edge.hidden = this.flight.mode !== 'eye' || !view;
    if (!view) return;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const wide = Math.min(width, height * view.aspect);
    this.image_edge.style.width = `${wide}px`;
    this.image_edge.style.height = `${wide / view.aspect}px`;
  }

  private object_under(event: PointerEvent | MouseEvent): number {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const caster = new Raycaster();
    caster.setFromCamera(at, this.flight.camera);
    const states = this.states(), shown = this.store.get('shown');
    return pick(this.place, caster.ray.origin.toArray() as Vector, caster.ray.direction.toArray() as Vector,
                (id) => !states || shown[states[id]], this.look.cut.value);
  }

  private states(): Uint8Array | null {
    const view = this.state_camera();
    return view && this.walk.states(this.store.get('run'), view.frame);
  }

  private hover(event: PointerEvent): void {
    if (event.buttons !== 0) return this.tooltip.hide();
    const id = this.object_under(event);
    if (id < 0) return this.tooltip.hide();
    const states = this.states(), checked = this.walk.checked(this.store.get('run'), this.store.state_frame);
    this.tooltip.show(event, describe_object(id, this.place, states, checked), STATE_NAMES[states?.[id] ?? UNKNOWN]);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement as HTMLElement;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.flight.resize(width / height);
    if (this.flight.mode !== 'free') this.go(this.flight.mode);
    this.frame_image();
  }

  private wake(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => {
      this.waiting = false;
      const moving = this.flight.advance(now);
      this.renderer.render(this.scene, this.flight.camera);
      if (moving) this.wake();
    });
  }
}
