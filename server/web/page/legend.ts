// The colour scale: what the colours mean, how often each value is there, and two handles for the range.

import { h, short } from './dom';
import { diverging } from './view/colours';
import type { Distribution, Quantity } from './view/quantities';

const kSteps = 400;

export class Legend {
  readonly element: HTMLElement;
  private readonly canvas = h('canvas', { class: 'histogram', width: 384, height: 96 });
  private readonly low = this.handle('Lowest value shown as colour');
  private readonly high = this.handle('Highest value shown as colour');
  private readonly title = h('strong');
  private readonly help = h('p', { class: 'faint' });
  private readonly lowText = h('output');
  private readonly highText = h('output');
  private distribution: Distribution = { limit: 1, suggested: 1, bins: new Float32Array(1) };

  constructor(private readonly changed: (low: number, high: number) => void) {
    const reset = h('button', { type: 'button', class: 'quiet', textContent: 'Reset', title: 'Back to the range of 95 % of the vertices' });
    reset.onclick = () => this.setRange(-this.distribution.suggested, this.distribution.suggested);
    this.element = h(
      'section',
      { class: 'legend', hidden: true, aria: { label: 'Colour scale' }, data: { test: 'legend' } },
      h('header', {}, this.title, reset),
      h('div', { class: 'scale' }, this.canvas, this.low, this.high),
      h('div', { class: 'ends' }, this.lowText, this.highText),
      this.help,
    );
  }

  range(): [number, number] {
    return [this.valueOf(this.low), this.valueOf(this.high)];
  }

  /// Shows the scale of a quantity, and the range that 95 % of its values stay in.
  show(quantity: Quantity, distribution: Distribution): void {
    this.distribution = distribution;
    this.title.textContent = `${quantity.label} (${quantity.unit})`;
    this.help.textContent = quantity.help;
    this.element.hidden = false;
    this.setRange(-distribution.suggested, distribution.suggested);
  }

  hide(): void {
    this.element.hidden = true;
  }

  private setRange(low: number, high: number): void {
    const step = (value: number): string => String(Math.round((value / this.distribution.limit) * kSteps));
    this.low.value = step(low);
    this.high.value = step(high);
    this.moved(this.high);
  }

  private handle(label: string): HTMLInputElement {
    const input = h('input', { type: 'range', min: String(-kSteps), max: String(kSteps), step: '1', aria: { label } });
    input.oninput = () => this.moved(input);
    return input;
  }

  private valueOf(input: HTMLInputElement): number {
    return (input.valueAsNumber / kSteps) * this.distribution.limit;
  }

  /// Keeps the handles in order, tells the range, and draws.
  private moved(input: HTMLInputElement): void {
    const gap = 4;
    if (this.high.valueAsNumber - this.low.valueAsNumber < gap) {
      if (input === this.low) this.low.value = String(this.high.valueAsNumber - gap);
      else this.high.value = String(this.low.valueAsNumber + gap);
    }
    const [low, high] = this.range();
    this.lowText.textContent = short(low);
    this.highText.textContent = short(high);
    this.low.setAttribute('aria-valuetext', short(low));
    this.high.setAttribute('aria-valuetext', short(high));
    this.draw(low, high);
    this.changed(low, high);
  }

  /// The colours and above them how often each is there; by square root, so that rare values are seen.
  private draw(low: number, high: number): void {
    const context = this.canvas.getContext('2d');
    if (!context) return;
    const { width, height } = this.canvas;
    const { bins, limit } = this.distribution;
    const most = bins.reduce((a, b) => Math.max(a, b), 1);
    const ramp = 18;
    const ink = getComputedStyle(this.element).getPropertyValue('--faint');
    context.clearRect(0, 0, width, height);
    for (let x = 0; x < width; ++x) {
      const value = ((x + 0.5) / width) * 2 * limit - limit;
      const t = (2 * (value - low)) / (high - low) - 1;
      const [r, g, b] = diverging(Math.max(-1, Math.min(1, t)));
      const share = Math.sqrt((bins[Math.floor((x / width) * bins.length)] ?? 0) / most);
      const bar = share * (height - ramp - 6);
      context.fillStyle = `rgb(${r} ${g} ${b} / ${Math.abs(t) <= 1 ? 1 : 0.45})`;
      context.fillRect(x, height - ramp, 1, ramp);
      context.fillStyle = ink;
      context.fillRect(x, height - ramp - 2 - bar, 1, bar);
    }
  }
}
