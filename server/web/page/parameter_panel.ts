// The parameters of a run, from what the service says of them (GET /v1/methods). A preset is all that most
// runs need; the rest is folded away. Only what differs from the preset is sent.

import type { Methods, Parameters, Schema } from './api';
import { h } from './dom';

/// What the page decides by itself: it shows all curvature and features, and asks for formats at a download.
const kOwn = new Set(['preset', 'curvature', 'features', 'output', 'compression', 'draco']);

const kGroups: [string, string[]][] = [
  ['Method', ['method', 'strength', 'noise', 'surface', 'integration', 'steps', 'step_size']],
  ['Features', ['feature_angle', 'lambda', 'transition', 'guards']],
  ['Curvature', ['curvature_smoothing', 'curvature_measure', 'curvature_space', 'colors']],
  ['What may move', ['boundary', 'fixed_vertices', 'meshes', 'nodes', 'weld']],
];

const titleOf = (name: string): string => {
  const text = name.replaceAll('_', ' ');
  return text[0]!.toUpperCase() + text.slice(1);
};

/// One parameter: its element, its value (undefined where it is left alone), and how to show a default.
interface Field {
  pointer: string;
  element: HTMLElement;
  input: HTMLElement;
  error: HTMLElement;
  value: () => unknown;
  clear: () => void;
  suggest: (preset: unknown) => void;
}

export class ParameterPanel {
  readonly element = h('div', { class: 'parameters' });
  private readonly fields: Field[] = [];
  private preset = 'auto';

  constructor(
    private readonly methods: Methods,
    private readonly changed: () => void,
  ) {
    this.element.append(this.presets(), this.everything());
    this.choose('auto');
  }

  /// What the service is to be asked for. Throws an Error that names a field which cannot be read.
  parameters(): Parameters {
    const out: Parameters = this.preset === 'auto' ? {} : { preset: this.preset };
    for (const field of this.fields) {
      const value = field.value();
      if (value === undefined) continue;
      const path = field.pointer.split('/').slice(1);
      let place = out;
      for (const name of path.slice(0, -1)) place = (place[name] ??= {}) as Parameters;
      place[path.at(-1)!] = value;
    }
    return out;
  }

  /// Shows at the field what the service says of it. True where there is such a field.
  blame(pointer: string, detail: string): boolean {
    const field = this.fields
      .filter((one) => pointer === one.pointer || pointer.startsWith(`${one.pointer}/`))
      .sort((a, b) => b.pointer.length - a.pointer.length)[0];
    if (!field) return false;
    field.error.textContent = detail;
    field.input.setAttribute('aria-invalid', 'true');
    for (let at: HTMLElement | null = field.element; at; at = at.parentElement) {
      if (at instanceof HTMLDetailsElement) at.open = true;
    }
    field.input.focus();
    return true;
  }

  forgive(): void {
    for (const field of this.fields) {
      field.error.textContent = '';
      field.input.removeAttribute('aria-invalid');
    }
  }

  private presets(): HTMLElement {
    const help = h('p', { class: 'faint', role: 'status' });
    const buttons = this.methods.presets.map((preset) => {
      const input = h('input', { type: 'radio', name: 'preset', value: preset.name, checked: preset.name === 'auto' });
      input.onchange = () => {
        help.textContent = preset.description;
        this.choose(preset.name);
      };
      return h('label', { title: preset.description }, input, h('span', {}, preset.name));
    });
    help.textContent = this.methods.presets[0]?.description ?? '';
    return h(
      'fieldset',
      { class: 'presets' },
      h('legend', {}, 'Preset'),
      h('div', { class: 'segments' }, ...buttons),
      help,
    );
  }

  private everything(): HTMLElement {
    const properties = this.methods.parameters.properties;
    const named = new Set(kGroups.flatMap(([, names]) => names));
    const rest = Object.keys(properties).filter((name) => !named.has(name) && !kOwn.has(name));
    const groups = [...kGroups, ['More', rest] as [string, string[]]].map(([title, names]) => {
      const known = names.filter((name) => properties[name]);
      return h(
        'fieldset',
        {},
        h('legend', {}, title),
        ...known.map((name) => this.property(`/${name}`, name, properties[name]!)),
      );
    });
    const reset = h('button', { type: 'button', class: 'quiet', textContent: 'Clear all of these' });
    reset.onclick = () => {
      this.fields.forEach((field) => field.clear());
      this.forgive();
      this.changed();
    };
    return h('details', { class: 'everything' }, h('summary', {}, 'All parameters'), ...groups, reset);
  }

  private property(pointer: string, name: string, schema: Schema): HTMLElement {
    const inner = schema.properties;
    if (!inner) return this.field(pointer, name, schema);
    return h(
      'details',
      { class: 'nested' },
      h('summary', {}, titleOf(name)),
      h('p', { class: 'faint' }, schema.description ?? ''),
      ...Object.entries(inner).map(([key, one]) => this.property(`${pointer}/${key}`, key, one)),
    );
  }

  private field(pointer: string, name: string, schema: Schema): HTMLElement {
    const id = `parameter${pointer.replaceAll('/', '-')}`;
    const { input, value, clear, suggest } = this.control(schema);
    input.id = id;
    const error = h('p', { class: 'error', role: 'alert' });
    const unit = schema['x-unit'] ? ` (${schema['x-unit']})` : '';
    const help = h('small', { class: 'faint', id: `${id}-help` }, (schema.description ?? '') + unit);
    input.setAttribute('aria-describedby', `${id}-help`);
    const element = h('div', { class: 'field' }, h('label', { htmlFor: id }, titleOf(name)), input, help, error);
    this.fields.push({ pointer, element, input, error, value, clear, suggest });
    input.addEventListener('change', () => {
      if (name === 'method') help.textContent = this.methodWords((input as HTMLSelectElement).value) || (schema.description ?? '');
      error.textContent = '';
      input.removeAttribute('aria-invalid');
      this.changed();
    });
    return element;
  }

  private methodWords(name: string): string {
    const method = this.methods.methods.find((one) => one.name === name);
    return method ? `${method.good_for} ${method.choose_when}` : '';
  }

  private control(schema: Schema): Omit<Field, 'pointer' | 'element' | 'error'> {
    const kinds = [schema, ...(schema.anyOf ?? [])];
    if (schema.enum) return this.choice(schema.enum);
    if (kinds.some((kind) => kind.type === 'boolean')) return this.choice(['true', 'false']);
    const number = kinds.find((kind) => kind.type === 'number' || kind.type === 'integer');
    return number && !kinds.some((kind) => kind.type === 'array') ? this.number(kinds, number) : this.json();
  }

  private choice(options: string[]): Omit<Field, 'pointer' | 'element' | 'error'> {
    const first = h('option', { value: '' });
    const input = h('select', {}, first, ...options.map((option) => h('option', { value: option }, option)));
    const text = options[0] === 'true' ? JSON.parse : (value: string) => value;
    return {
      input,
      value: () => (input.value === '' ? undefined : text(input.value)),
      clear: () => (input.value = ''),
      suggest: (preset) => (first.textContent = `${String(preset)} (preset)`),
    };
  }

  private number(kinds: Schema[], number: Schema): Omit<Field, 'pointer' | 'element' | 'error'> {
    const input = h('input', { type: 'number', step: number.type === 'integer' ? '1' : 'any' });
    const others = kinds.filter((kind) => 'const' in kind).map((kind) => String(kind.const));
    if (number.minimum !== undefined && number.minimum >= 0) input.min = String(number.minimum);
    if (number.maximum !== undefined && number.maximum < 1e9) input.max = String(number.maximum);
    return {
      input,
      value: () => (Number.isNaN(input.valueAsNumber) ? undefined : input.valueAsNumber),
      clear: () => (input.value = ''),
      suggest: (preset) => (input.placeholder = String(preset ?? others[0] ?? '')),
    };
  }

  private json(): Omit<Field, 'pointer' | 'element' | 'error'> {
    const input = h('input', { type: 'text', spellcheck: false, autocomplete: 'off' });
    return {
      input,
      value: () => {
        if (input.value.trim() === '') return undefined;
        try {
          return JSON.parse(input.value) as unknown;
        } catch {
          throw new Error(`“${input.value}” cannot be read: write it as JSON, such as [0, 3, 17].`);
        }
      },
      clear: () => (input.value = ''),
      suggest: (preset) => (input.placeholder = preset === undefined ? 'all' : JSON.stringify(preset)),
    };
  }

  /// Takes a preset: what fields show as their default is what it has.
  private choose(name: string): void {
    this.preset = name;
    const stated = this.methods.presets.find((preset) => preset.name === name)?.parameters ?? {};
    for (const field of this.fields) {
      let own: unknown = stated;
      let schema: Schema = { properties: this.methods.parameters.properties };
      for (const key of field.pointer.split('/').slice(1)) {
        own = (own as Parameters | undefined)?.[key];
        schema = schema.properties![key]!;
      }
      field.suggest(own ?? schema.default);
    }
    this.changed();
  }
}
