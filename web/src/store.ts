// What the panels share: the frame shown, the method shown, what is frozen, hidden or selected. A panel changes it with
// set() and hears of changes with on(); panels do not know each other.

export interface Shared {
  frame: number;            // index into the frames of the walk
  run: number;              // index of the method shown
  frozen: number | null;    // frame whose states stay while the camera goes on
  playing: boolean;
  shown: boolean[];         // per state number, whether its objects are drawn
  cut: number;              // objects are drawn up to this height, world space; Infinity for all
  selected: number | null;  // object id
  theme: number;            // counts changes of the colour scheme
}

export class Store {
  private state: Shared;
  private listeners: { keys: (keyof Shared)[]; hear: () => void }[] = [];

  constructor(readonly frame_count: number) {
    this.state = {
      frame: 0, run: 0, frozen: null, playing: false, shown: [true, true, true, true, true, true],
      cut: Infinity, selected: null, theme: 0,
    };
  }

  get<K extends keyof Shared>(key: K): Shared[K] {
    return this.state[key];
  }

  /** The frame whose states colour the objects. */
  get state_frame(): number {
    return this.state.frozen ?? this.state.frame;
  }

  set(patch: Partial<Shared>): void {
    if (patch.frame !== undefined) patch.frame = Math.max(0, Math.min(this.frame_count - 1, Math.round(patch.frame)));
    const keys = (Object.keys(patch) as (keyof Shared)[]).filter((key) => patch[key] !== this.state[key]);
    if (keys.length === 0) return;
    Object.assign(this.state, patch);
    for (const listener of this.listeners)
      if (listener.keys.some((key) => keys.includes(key))) listener.hear();
  }

  /** Calls `hear` now and whenever one of the keys changes. */
  on(keys: (keyof Shared)[], hear: () => void): void {
    this.listeners.push({ keys, hear });
    hear();
  }
}
