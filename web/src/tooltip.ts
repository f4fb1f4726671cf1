// The small label beside the pointer that names an object.
import { state_words, UNKNOWN } from './data.ts';
import { element } from './dom.ts';
import { significant } from './format.ts';
import type { Placement } from './placement.ts';

export class Tooltip {
  private readonly swatch = element('span', { class: 'swatch' });
  private readonly text = element('span');
  readonly root = element('div', { class: 'tooltip', hidden: true, role: 'tooltip' }, this.swatch, this.text);

  /** Beside the pointer, on the side where there is room. */
  show(event: MouseEvent, text: string, state_name: string): void {
    const stage = (this.root.offsetParent ?? this.root.parentElement) as HTMLElement;
    const { left, top, width } = stage.getBoundingClientRect();
    const x = event.clientX - left, y = event.clientY - top;
    this.root.hidden = false;
    this.swatch.style.background = `var(--${state_name})`;
    this.text.textContent = text;
    const own = this.root.offsetWidth;
    this.root.style.transform = `translate(${Math.round(x + own + 20 > width ? x - own - 12 : x + 14)}px, ${Math.round(y + 14)}px)`;
  }

  hide(): void {
    this.root.hidden = true;
  }
}

export function describe_object(id: number, place: Placement, states: Uint8Array | null, checked: boolean): string {
  const size = place.size(id).map((length) => significant(length)).join(' × ');
  const { name, meaning } = state_words(states ? states[id] : UNKNOWN, checked);
  return `Object ${id} · ${name}: ${meaning} · ${size} m`;
}
