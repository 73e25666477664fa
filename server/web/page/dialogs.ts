// Questions and help in front of the page.

import { h } from './dom';

const kKeys: [string, string][] = [
  ['O', 'Open a mesh'],
  ['Enter', 'Denoise'],
  ['1 2 3 4', 'Split, side by side, before, after'],
  ['[ ]', 'Move the split'],
  ['C', 'Next colour'],
  ['S W F D', 'Flat shading, wireframe, features, directions'],
  ['R', 'Reset the view'],
  ['Arrows + −', 'Turn and zoom, with the viewer in focus'],
  ['?', 'This help'],
];

function open(dialog: HTMLDialogElement): void {
  document.body.append(dialog);
  dialog.addEventListener('close', () => dialog.remove());
  dialog.showModal();
}

export function showKeys(): void {
  const close = h('button', { type: 'button', textContent: 'Close' });
  const rows = kKeys.flatMap(([key, what]) => [h('dt', {}, h('kbd', {}, key)), h('dd', {}, what)]);
  const dialog = h('dialog', { aria: { label: 'Keys' } }, h('h2', {}, 'Keys'), h('dl', { class: 'keys' }, ...rows), close);
  close.onclick = () => dialog.close();
  open(dialog);
}

let asking: Promise<string | null> | null = null;

/// Asks for a key; null where a person gives none. Several that ask at once share one answer.
export function askForKey(): Promise<string | null> {
  asking ??= new Promise<string | null>((resolve) => {
    const input = h('input', { type: 'password', autocomplete: 'off', required: true, id: 'key' });
    const form = h(
      'form',
      {},
      h('h2', {}, 'This service asks for a key'),
      h('p', {}, 'Whoever runs it makes one with fairwayd keys add. It stays in this tab and goes to this service only.'),
      h('label', { htmlFor: 'key' }, 'Key'),
      input,
      h('div', { class: 'row' }, h('button', { type: 'submit', class: 'main', textContent: 'Use it' })),
    );
    const dialog = h('dialog', { aria: { label: 'Key' } }, form);
    let given: string | null = null;
    form.onsubmit = (event) => {
      event.preventDefault();
      given = input.value.trim();
      dialog.close();
    };
    dialog.addEventListener('close', () => {
      asking = null;
      resolve(given);
    });
    open(dialog);
  });
  return asking;
}
