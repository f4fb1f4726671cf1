// The small label beside the pointer that names an object.
import { state_words, UNKNOWN } from './data.ts';
import { element } from './dom.ts';
import { significant } from './format.ts';
import type { Placement } from './placement.ts';

export class Tooltip {
  private readonly swatch = element('span', { class: 'swatch' });
  private readonly text = element('span');
  readonly root = element('div', { class: 'tooltip', hidden: true, role: 'tooltip' }, this.swatch, this.text);

  /** Beside the pointer, within the stage: it wraps where the stage is narrow. */
  show(event: MouseEvent, text: string, state_name: string): void {
    const stage = (this.root.offsetParent ?? this.root.parentElement) as HTMLElement;
    const { left, top, width, height } = stage.getBoundingClientRect();
    const x = event.clientX - left, y = event.clientY - top;
    this.root.hidden = false;
    this.swatch.style.background = `var(--${state_name})`;
    this.text.textContent = text;
    this.root.style.maxWidth = `${width - 12}px`;
    const { offsetWidth: wide, offsetHeight: tall } = this.root;
    const across = Math.max(6, Math.min(x + 14, width - wide - 6)), down = y + 18 + tall > height ? y - tall - 10 : y + 18;
    this.root.style.transform = `translate(${Math.round(across)}px, ${Math.round(down)}px)`;
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
