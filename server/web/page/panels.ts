// The parts of the panel: what is open, the result, the runs, the jobs of the service.

import { bytes, count, h, plural } from './dom';
import { isOver, kAside, type ApiError, type Job } from './api';
import { captionOf, nameOf, stageWords, type Run } from './run';
import { seconds } from './report';

export interface Format {
  label: string;
  output: string;
  compression?: string;
}

export const kFormats: readonly Format[] = [
  { label: 'GLB', output: 'glb' },
  { label: 'GLB, Draco', output: 'glb', compression: 'draco' },
  { label: 'GLB, meshopt', output: 'glb', compression: 'meshopt' },
  { label: 'glTF', output: 'gltf' },
  { label: 'Draco', output: 'drc' },
  { label: 'PLY', output: 'ply' },
  { label: 'OBJ', output: 'obj' },
  { label: 'STL', output: 'stl' },
];

/// An error with its remedy.
export function errorBox(error: ApiError): HTMLElement {
  return h(
    'div',
    { class: 'notice bad', role: 'alert', data: { test: 'error' } },
    h('strong', {}, error.problem.title),
    h('p', {}, error.problem.detail),
  );
}

/// The row of a run in the list of runs.
export function runRow(run: Run, actions: { show: () => void; cancel: () => void; forget: () => void }): HTMLElement {
  const state = run.error ? 'failed' : (run.job?.state ?? 'upload');
  const over = !!run.error || (!!run.job && isOver(run.job));
  const show = h('button', { type: 'button', class: 'link', textContent: captionOf(run), disabled: state !== 'succeeded' });
  show.onclick = actions.show;
  const end = h('button', { type: 'button', class: 'quiet', textContent: over ? 'Forget' : 'Cancel' });
  end.onclick = over ? actions.forget : actions.cancel;
  const row = h('li', { data: { test: 'run', state } }, show, end);
  if (!over) {
    row.append(
      h('progress', { max: 1, value: run.progress, aria: { label: `Progress of run ${run.number}` } }),
      h('small', { class: 'faint' }, stageWords[run.stage] ?? run.stage),
    );
  } else if (state !== 'succeeded') {
    row.append(h('small', { class: 'bad' }, run.error?.problem.title ?? state));
  } else {
    row.append(h('small', { class: 'faint' }, timeWords(run.job!)));
  }
  return row;
}

function timeWords(job: Job): string {
  if (job.cached) return 'known from an earlier run';
  return `${seconds((Date.parse(job.finished ?? '') - Date.parse(job.started ?? '')) / 1000 || 0)} of computing`;
}

/// Two lists to choose what is compared with what.
export function comparison(
  runs: readonly Run[],
  left: Run | null,
  right: Run | null,
  choose: (side: 'left' | 'right', run: Run | null) => void,
): HTMLElement {
  const list = (side: 'left' | 'right', chosen: Run | null): HTMLElement => {
    const options = runs
      .filter((run) => run.job?.state === 'succeeded')
      .map((run) => h('option', { value: String(run.number), selected: run === chosen }, captionOf(run)));
    const select = h('select', {}, h('option', { value: '', selected: !chosen }, 'Input'), ...options);
    select.onchange = () => choose(side, runs.find((run) => String(run.number) === select.value) ?? null);
    return h('label', {}, side === 'left' ? 'Left' : 'Right', select);
  };
  return h('div', { class: 'comparison' }, list('left', left), list('right', right));
}

/// The rows of the jobs that the service knows.
export function jobRows(jobs: readonly Job[], open: (job: Job) => void, remove: (job: Job) => void): HTMLElement[] {
  return jobs.filter((job) => !job.labels?.includes(kAside)).map((job) => {
    const file = job.labels?.find((label) => label.startsWith('file:'))?.slice(5) ?? `${job.input.format} of ${bytes(job.input.bytes)}`;
    const when = new Date(job.created).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });
    const show = h('button', { type: 'button', class: 'link', textContent: file, disabled: job.state !== 'succeeded', title: job.id });
    show.onclick = () => open(job);
    const forget = h('button', { type: 'button', class: 'quiet', textContent: isOver(job) ? 'Delete' : 'Cancel' });
    forget.onclick = () => remove(job);
    const words = `${when} · ${job.state}${job.problem ? `: ${job.problem.title}` : ''} · ${nameOf(chosenOf(job.parameters))}`;
    return h('li', {}, show, forget, h('small', { class: 'faint' }, words));
  });
}

/// Of the parameters of a job those that a person is likely to have chosen.
export function chosenOf(parameters: Record<string, unknown>): Record<string, unknown> {
  const chosen: Record<string, unknown> = {};
  if (parameters.preset !== 'auto') chosen.preset = parameters.preset;
  if (parameters.method === 'none') chosen.method = 'none';
  for (const name of ['strength', 'steps', 'feature_angle']) if (parameters[name] !== 'auto' && parameters[name] !== undefined) chosen[name] = parameters[name];
  return chosen;
}

export const sizeWords = (vertices: number, triangles: number): string =>
  `${plural(vertices, 'vertex', 'vertices')}, ${count(triangles)} ${triangles === 1 ? 'triangle' : 'triangles'}`;
