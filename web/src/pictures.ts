// Pictures of chosen frames: a strip with one kind shown at a time, and a dialog that shows one of them large.
import type { Picture, Walk } from './data.ts';
import { choice, element } from './dom.ts';
import type { Store } from './store.ts';

const KINDS: Record<string, string> = { shaded: 'Shaded', object: 'Objects', depth: 'Depth', overdraw: 'Overdraw' };
const kind_name = (kind: string) => KINDS[kind] ?? kind;
const source = (picture: Picture) => `data:image/png;base64,${picture.png}`;

export function pictures(walk: Walk, store: Store): HTMLElement {
  const root = element('section', { 'aria-labelledby': 'pictures-title' });
  const title = element('h2', { id: 'pictures-title' }, 'Pictures');
  if (walk.pictures.length === 0) {
    root.append(title, element('p', { class: 'absent' }, 'No pictures were stored with this walk.'));
    return root;
  }
  const kinds = [...new Set([...Object.keys(KINDS), ...walk.pictures.map((picture) => picture.kind)])]
    .filter((kind) => walk.pictures.some((picture) => picture.kind === kind));
  const strip = element('div', { class: 'strip' });
  const note = element('p', { class: 'absent' });
  const large = new Large(walk, store);
  const name = (index: number) => walk.frame(0, index)?.frame ?? index;
  let items: { frame: number; item: HTMLElement }[] = [];
  const show = (kind: string) => {
    items = walk.pictures.filter((picture) => picture.kind === kind).sort((a, b) => a.frame - b.frame).map((picture) => {
      const caption = `frame ${name(picture.frame)}`;
      return { frame: picture.frame, item: element('button', { type: 'button', class: 'thumb', onclick: () => large.open(picture) },
        element('img', { src: source(picture), alt: `${kind_name(kind)}, ${caption}`, decoding: 'async', style: walk.size && `aspect-ratio: ${walk.size[0]} / ${walk.size[1]}` }), element('span', {}, caption)) };
    });
    note.textContent = kind.startsWith('overdraw')
      ? 'How many surfaces of what the method reported lie over each pixel: dark blue 1, blue 2, green 4, yellow 8, red 16, white 32 and more.' : '';
    strip.replaceChildren(...items.map(({ item }) => item));
    mark();
  };
  const mark = () => {
    const now = store.get('frame');
    const nearest = items.reduce((best, { frame }) => Math.min(best, Math.abs(frame - now)), Infinity);
    for (const { frame, item } of items) item.classList.toggle('near', Math.abs(frame - now) === nearest);
  };
  const selector = choice('Kind of picture', kinds.map((kind) => ({ value: kind, text: kind_name(kind) })), kinds[0], show);
  root.append(element('div', { class: 'bar' }, title, selector.root), strip, note, large.dialog);
  show(kinds[0]);
  store.on(['frame'], mark);
  return root;
}

class Large {
  private readonly image = element('img', { alt: '' });
  private readonly caption = element('span', { class: 'caption' });
  private readonly kinds = element('div', { class: 'bar' });
  readonly dialog = element('dialog', { class: 'large', 'aria-label': 'Picture', onclick: (event: MouseEvent) => {
    if (event.target === this.dialog || event.target === this.image) this.dialog.close();
  } }, this.kinds, this.image);
  private shown: Picture | null = null;

  constructor(private readonly walk: Walk, private readonly store: Store) {
    this.dialog.addEventListener('keydown', (event) => {
      if (event.key === 'ArrowRight') this.step(1);
      if (event.key === 'ArrowLeft') this.step(-1);
    });
  }

  open(picture: Picture): void {
    this.shown = picture;
    const name = this.walk.frame(0, picture.frame)?.frame ?? picture.frame;
    this.image.src = source(picture);
    if (this.walk.size) this.image.style.setProperty('--aspect', String(this.walk.size[0] / this.walk.size[1]));
    this.image.alt = `${kind_name(picture.kind)}, frame ${name}`;
    this.caption.textContent = `Frame ${name}`;
    const same = this.walk.pictures.filter((other) => other.frame === picture.frame);
    const selector = choice('Kind of picture', same.map((other) => ({ value: other.kind, text: kind_name(other.kind) })), picture.kind, (kind) => {
      const other = same.find((candidate) => candidate.kind === kind);
      if (other) this.open(other);
    });
    this.kinds.replaceChildren(this.caption, selector.root,
      element('button', { type: 'button', onclick: () => { this.store.set({ frame: picture.frame, playing: false }); this.dialog.close(); } }, 'Go to this frame'),
      element('button', { type: 'button', class: 'quiet', onclick: () => this.dialog.close() }, 'Close'));
    if (!this.dialog.open) this.dialog.showModal();
  }

  /** The next picture of the same kind. */
  private step(by: number): void {
    if (!this.shown) return;
    const kind = this.shown.kind;
    const same = this.walk.pictures.filter((picture) => picture.kind === kind).sort((a, b) => a.frame - b.frame);
    const next = same[same.indexOf(this.shown) + by];
    if (next) this.open(next);
  }
}
