// Builds elements; the page has no framework.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, unknown>;

/** Attributes that start with "on" become listeners; true sets an empty attribute, false and null leave it out. */
export function element<K extends keyof HTMLElementTagNameMap>(
    tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value as EventListener);
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, String(value));
  }
  made.append(...children.filter((child): child is Node | string => !!child));
  return made;
}

/** A row of buttons of which one is on. */
export function choice<T extends string>(
    label: string, options: { value: T; text: string; title?: string }[], chosen: T, choose: (value: T) => void) {
  const buttons = options.map((option) =>
    element('button', {
      type: 'button', 'data-value': option.value, title: option.title, 'aria-pressed': option.value === chosen,
      onclick: () => { show(option.value); choose(option.value); },
    }, option.text));
  const show = (value: T | null) => {
    for (const button of buttons) button.setAttribute('aria-pressed', String(button.dataset.value === value));
  };
  show(chosen);
  const button = (value: T) => buttons[options.findIndex((option) => option.value === value)];
  return { root: element('div', { class: 'choice', role: 'group', 'aria-label': label }, ...buttons), show, button };
}

/** A colour of the page's scheme, such as "--seen". */
export const colour = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export const calm = () => matchMedia('(prefers-reduced-motion: reduce)').matches;
