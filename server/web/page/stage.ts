// The viewer with its tools: layout, colour, shading, overlays, the split, the scale.

import { h } from './dom';
import { Legend } from './legend';
import type { Layout, Look, Model, Side, Viewer } from './view';
import { distributionOf, kQuantities } from './view/quantities';

const kLayouts: [Layout, string, string][] = [
  ['split', 'Split', 'One over the other, with a split to drag (1)'],
  ['side', 'Side by side', 'Two views under one camera (2)'],
  ['before', 'Before', 'The left one alone (3)'],
  ['after', 'After', 'The right one alone (4)'],
];

type Toggle = 'flat' | 'wireframe' | 'features' | 'directions';
const kToggles: [Toggle, string, string][] = [
  ['flat', 'Flat', 'Flat shading shows faces as they are (S)'],
  ['wireframe', 'Wireframe', 'Edges only (W)'],
  ['features', 'Features', 'Vertices that are kept as features (F)'],
  ['directions', 'Directions', 'Principal directions: red the largest, blue the smallest curvature (D)'],
];

export class Stage {
  readonly element: HTMLElement;
  readonly canvas = h('canvas', { tabIndex: 0, aria: { label: 'Mesh. Arrow keys turn it, + and − zoom.' }, role: 'img' });
  private readonly divider = h('div', {
    class: 'divider',
    tabIndex: 0,
    role: 'separator',
    aria: { orientation: 'vertical', label: 'Split between before and after', valuemin: '0', valuemax: '100' },
    data: { test: 'divider' },
  });
  private readonly captions = { before: h('span', { class: 'caption left' }), after: h('span', { class: 'caption right' }) };
  private readonly layouts = new Map<Layout, HTMLInputElement>();
  private readonly toggles = new Map<Toggle, HTMLButtonElement>();
  private readonly colours = h('select', { aria: { label: 'Colour' } });
  private readonly legend = new Legend((low, high) => {
    this.look.low = low;
    this.look.high = high;
    this.apply();
  });
  private readonly progress = h('progress', { max: 1, aria: { label: 'Progress' } });
  private readonly stageOfWork = h('span', { role: 'status' });
  private readonly busyBox = h('div', { class: 'busy', hidden: true }, this.stageOfWork, this.progress);
  private readonly tools: HTMLElement;
  private viewer: Viewer | null = null;
  private readonly look: Look = {
    layout: 'split',
    quantity: null,
    original: false,
    low: -1,
    high: 1,
    flat: true,
    wireframe: false,
    features: false,
    directions: false,
  };

  /// `wanted` is told when curvature of both sides is to be shown.
  constructor(private readonly wanted: () => void) {
    this.tools = this.makeTools();
    this.element = h(
      'section',
      { class: 'stage empty', aria: { label: 'Viewer' } },
      this.canvas,
      this.captions.before,
      this.captions.after,
      this.divider,
      this.tools,
      this.legend.element,
      this.busyBox,
    );
    this.makeDivider();
    this.canvas.addEventListener('keydown', (event) => this.key(event));
  }

  attach(viewer: Viewer): void {
    this.viewer = viewer;
    this.apply();
  }

  /// Puts a mesh with its name on a side.
  put(side: Side, model: Model | null, caption: string): void {
    this.viewer?.put(side, model);
    this.captions[side].textContent = caption;
    this.element.classList.toggle('empty', !this.viewer?.model('before') && !this.viewer?.model('after'));
    this.refresh();
  }

  fit(): void {
    this.viewer?.fit();
  }

  /// Says what is being done, and how far it is; null: nothing.
  busy(words: string | null, fraction = 0): void {
    this.busyBox.hidden = words === null;
    if (words !== null && this.stageOfWork.textContent !== words) this.stageOfWork.textContent = words;
    this.progress.value = fraction;
  }

  wantsCurvature(): boolean {
    return !!this.look.quantity || this.look.features || this.look.directions;
  }

  setLayout(layout: Layout): void {
    this.look.layout = layout;
    this.refresh();
  }

  setQuantity(id: string): void {
    this.colours.value = id;
    this.colours.dispatchEvent(new Event('change'));
  }

  toggle(name: Toggle): void {
    this.look[name] = !this.look[name];
    if (this.wantsCurvature()) this.wanted();
    this.refresh();
  }

  /// A key that the page gives to the viewer; true where it means something.
  command(key: string): boolean {
    const toggles: Record<string, Toggle> = { s: 'flat', w: 'wireframe', f: 'features', d: 'directions' };
    const layout = kLayouts[Number(key) - 1]?.[0];
    if (layout) this.setLayout(layout);
    else if (toggles[key]) this.toggle(toggles[key]);
    else if (key === 'c') this.setQuantity(this.nextColour());
    else if (key === 'r') this.fit();
    else if (key === '[' || key === ']') this.moveSplit(this.split() + (key === '[' ? -0.05 : 0.05));
    else return false;
    return true;
  }

  private nextColour(): string {
    const options = [...this.colours.options].map((option) => option.value);
    return options[(options.indexOf(this.colours.value) + 1) % options.length]!;
  }

  private makeTools(): HTMLElement {
    const layouts = kLayouts.map(([layout, label, title]) => {
      const input = h('input', { type: 'radio', name: 'layout', value: layout, checked: layout === 'split' });
      input.onchange = () => this.setLayout(layout);
      this.layouts.set(layout, input);
      return h('label', { title }, input, h('span', {}, label));
    });
    const toggles = kToggles.map(([name, label, title]) => {
      const button = h('button', { type: 'button', class: 'toggle', textContent: label, title });
      button.onclick = () => this.toggle(name);
      this.toggles.set(name, button);
      return button;
    });
    this.colours.append(
      h('option', { value: 'plain' }, 'Plain'),
      h('option', { value: 'original' }, 'As in the file'),
      h('optgroup', { label: 'Curvature' }, ...kQuantities.map((one) => h('option', { value: one.id }, one.label))),
    );
    this.colours.onchange = () => {
      this.look.original = this.colours.value === 'original';
      this.look.quantity = kQuantities.find((one) => one.id === this.colours.value) ?? null;
      if (this.look.quantity) this.wanted();
      this.rescale();
      this.refresh();
    };
    const fit = h('button', { type: 'button', class: 'toggle', textContent: 'Reset', title: 'Turn the camera to see all of it (R)' });
    fit.onclick = () => this.fit();
    return h(
      'div',
      { class: 'tools', role: 'toolbar', aria: { label: 'View' } },
      h('div', { class: 'segments layouts' }, ...layouts),
      h('div', { class: 'more' }, this.colours, ...toggles, fit),
    );
  }

  private makeDivider(): void {
    this.divider.onpointerdown = (event) => {
      this.divider.setPointerCapture(event.pointerId);
      event.preventDefault();
      this.divider.focus();
    };
    this.divider.onpointermove = (event) => {
      if (!this.divider.hasPointerCapture(event.pointerId)) return;
      const box = this.element.getBoundingClientRect();
      this.moveSplit((event.clientX - box.left) / box.width);
    };
    this.divider.onkeydown = (event) => {
      const by = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.moveSplit(this.split() + by);
    };
  }

  private split(): number {
    return this.viewer?.split ?? 0.5;
  }

  private moveSplit(to: number): void {
    if (this.viewer) this.viewer.split = Math.min(0.97, Math.max(0.03, to));
    this.refresh();
  }

  private key(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-0.12, 0],
      ArrowRight: [0.12, 0],
      ArrowUp: [0, 0.12],
      ArrowDown: [0, -0.12],
    };
    const turn = turns[event.key];
    if (turn) this.viewer?.turn(...turn);
    else if (event.key === '+') this.viewer?.zoom(0.9);
    else if (event.key === '-') this.viewer?.zoom(1 / 0.9);
    else return;
    event.preventDefault();
  }

  /// The scale for what is shown; the right side decides, because it is what is judged.
  rescale(): void {
    const { quantity } = this.look;
    const model = quantity && [this.viewer?.model('after'), this.viewer?.model('before')].find((one) => one?.has(quantity));
    if (!quantity || !model) {
      this.legend.hide();
      return;
    }
    this.legend.show(quantity, distributionOf(model.values(quantity)));
  }

  private hasBoth(): boolean {
    return !!this.viewer?.model('before') && !!this.viewer?.model('after');
  }

  /// Without two meshes there is nothing to part.
  private layout(): Layout {
    if (this.hasBoth()) return this.look.layout;
    return this.viewer?.model('after') ? 'after' : 'before';
  }

  /// What can be chosen follows from what there is.
  private refresh(): void {
    const both = this.hasBoth();
    const layout = this.layout();
    for (const [name, input] of this.layouts) {
      input.checked = name === layout;
      input.disabled = !both;
    }
    for (const [name, button] of this.toggles) button.setAttribute('aria-pressed', String(this.look[name]));
    const parted = layout === 'split' || layout === 'side';
    const percent = 100 * this.split();
    this.divider.hidden = !parted;
    this.divider.style.left = `${percent}%`;
    this.divider.setAttribute('aria-valuenow', percent.toFixed(0));
    this.captions.before.hidden = layout === 'after';
    this.captions.after.hidden = layout === 'before';
    this.apply();
  }

  private apply(): void {
    this.viewer?.apply({ ...this.look, layout: this.layout() });
  }
}
