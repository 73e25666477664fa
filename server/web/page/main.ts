// The page of fairwayd. The viewer's library comes behind the first view.

import { methods, onKeyWanted } from './api';
import { askForKey, showKeys } from './dialogs';
import { byId, h } from './dom';
import { errorBox } from './panels';
import { asApiError } from './run';
import { Stage } from './stage';
import { Workbench } from './workbench';

const kSamples: [string, string][] = [
  ['ring.glb', 'Noisy ring'],
  ['octahedron.glb', 'Noisy octahedron'],
  ['sheet.glb', 'Noisy open sheet'],
];

async function viewer(stage: Stage) {
  const library = await import('./view');
  try {
    const made = new library.Viewer(stage.canvas);
    stage.attach(made);
    return { library, viewer: made };
  } catch {
    throw new Error('This browser has no WebGL 2, which the viewer needs. The service can be used all the same: see the docs.');
  }
}

/// The drop zone in the middle of an empty viewer.
function welcome(open: (files: File[]) => void, complain: (error: unknown) => void): HTMLElement {
  const browse = h('button', { type: 'button', class: 'main', textContent: 'Choose files…' });
  browse.onclick = () => byId<HTMLInputElement>('files').click();
  const samples = kSamples.map(([file, label]) => {
    const button = h('button', { type: 'button', textContent: label, data: { sample: file } });
    button.onclick = async () => {
      try {
        const answer = await fetch(`/samples/${file}`);
        if (!answer.ok) throw new Error(`The sample could not be fetched (${answer.status}).`);
        open([new File([await answer.blob()], file)]);
      } catch (error) {
        complain(error);
      }
    };
    return button;
  });
  return h(
    'div',
    { class: 'welcome' },
    h('p', { class: 'drop' }, 'Drop a mesh here'),
    h('p', { class: 'faint' }, 'GLB, glTF with its files, Draco, PLY, OBJ or STL. It goes to this service and nowhere else.'),
    browse,
    h('p', { class: 'faint' }, 'or try'),
    h('div', { class: 'row' }, ...samples),
  );
}

function listen(stage: Stage, bench: Workbench): void {
  const input = byId<HTMLInputElement>('files');
  byId('open').onclick = () => input.click();
  byId('keys').onclick = showKeys;
  input.onchange = () => {
    void bench.openFiles([...(input.files ?? [])]);
    input.value = '';
  };
  const over = (on: boolean) => (event: DragEvent) => {
    event.preventDefault();
    stage.element.classList.toggle('over', on);
  };
  addEventListener('dragover', over(true));
  addEventListener('dragleave', over(false));
  addEventListener('drop', (event) => {
    over(false)(event);
    void bench.openFiles([...(event.dataTransfer?.files ?? [])]);
  });
  addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    const typing = target.closest('input:not([type=radio], [type=range]), select, textarea, dialog');
    const pressing = event.key === 'Enter' && target.closest('button, summary, a');
    if (typing || pressing || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === '?') showKeys();
    else if (event.key === 'o') input.click();
    else if (event.key === 'Enter') void bench.denoise();
    else if (!stage.command(event.key.toLowerCase())) return;
    event.preventDefault();
  });
}

async function start(): Promise<void> {
  onKeyWanted(askForKey);
  const main = byId('main');
  let bench: Workbench | null = null;
  const stage = new Stage(() => void bench?.measureBefore());
  const view = viewer(stage);
  const complain = (error: unknown): void => stage.element.append(errorBox(asApiError(error)));
  view.catch(complain);
  try {
    bench = new Workbench(stage, view, await methods());
  } catch (error) {
    main.append(errorBox(asApiError(error)));
    return;
  }
  const made = bench;
  stage.element.append(welcome((files) => void made.openFiles(files), complain));
  main.append(stage.element, made.element, h('footer', { class: 'faint' }, `fairway ${FAIRWAY_VERSION}`));
  listen(stage, made);
  performance.mark('interactive');
  const job = /^#job=([A-Za-z0-9_-]+)$/.exec(location.hash)?.[1];
  if (job) void made.openJob(job);
}

void start();
