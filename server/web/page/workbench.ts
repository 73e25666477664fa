// One mesh at a time: what is open, its runs, and what of them is seen.

import { ApiError, cancel, inspect, isOver, listJobs, remove, result, showJob } from './api';
import { labelOf, type Input, type Job, type Methods } from './api';
import { curlOf } from './curl';
import { byId, bytes, h } from './dom';
import { ParameterPanel } from './parameter_panel';
import { chosenOf, comparison, errorBox, jobRows, kFormats, runRow, sizeWords, type Format } from './panels';
import { inspectionLines, reportLines } from './report';
import { asApiError, captionOf, convert, execute, measure, newRun, stageWords, type Run } from './run';
import type { Stage } from './stage';
import type { Model, Viewer } from './view';

type View = typeof import('./view');

/// Beyond this a file is looked into only by a run.
const kMostInspected = 64e6;

interface Open {
  name: string;
  input: Input;
  before: Model | null;
  measured: boolean; ///< `before` has curvature
  measuring: Promise<void> | null;
  runs: Run[];
  left: Run | null; ///< null: the input
  right: Run | null;
}

export class Workbench {
  readonly element = h('aside', { class: 'panel', aria: { label: 'Denoising' } });
  private readonly fileBox = h('section', { class: 'box', data: { test: 'file' } });
  private readonly runButton = h('button', { type: 'button', class: 'main', textContent: 'Denoise', data: { test: 'denoise' } });
  private readonly errors = h('div', { aria: { live: 'polite' } });
  private readonly resultBox = h('section', { class: 'box', hidden: true, data: { test: 'result' } });
  private readonly runsBox = h('section', { class: 'box', hidden: true });
  private readonly jobList = h('ul', { class: 'rows' });
  private readonly jobsBox: HTMLDetailsElement;
  private readonly parameters: ParameterPanel;
  private readonly shown = new Map<Run, Model>();
  private open: Open | null = null;
  private counter = 0;

  constructor(
    private readonly stage: Stage,
    private readonly view: Promise<{ library: View; viewer: Viewer }>,
    methods: Methods,
  ) {
    this.parameters = new ParameterPanel(methods, () => this.showCurl());
    this.runButton.onclick = () => void this.denoise();
    const more = h('button', { type: 'button', class: 'quiet', textContent: 'Refresh' });
    more.onclick = () => void this.listJobs();
    this.jobsBox = h('details', { class: 'box' }, h('summary', {}, 'Jobs on this service'), more, this.jobList);
    this.jobsBox.ontoggle = () => this.jobsBox.open && void this.listJobs();
    this.element.append(
      this.fileBox,
      h('section', { class: 'box' }, this.parameters.element, h('div', { class: 'row' }, this.runButton), this.errors),
      this.runsBox,
      this.resultBox,
      this.jobsBox,
    );
    this.showFile();
  }

  /// Opens a mesh with its side files: shows it at once, and asks the service what is in it.
  async openFiles(files: File[]): Promise<void> {
    const ordered = mainFirst(files);
    if (ordered.length === 0) return;
    const open = this.begin(ordered[0]!.name, { files: ordered });
    this.showFile('Reading the file …');
    const { library } = await this.view;
    try {
      this.showBefore(open, new library.Model(await library.loadFiles(ordered)));
      this.showFile();
    } catch (error) {
      // The service reads more than the viewer does: what it makes of the file can be seen.
      this.showFile('The viewer cannot read this file by itself; the service is asked.');
      await this.measureBefore();
      if (!open.before && this.open === open) this.showFile(missingOr(error));
    }
    await this.inspect(open);
  }

  /// Opens a job that the service has, with its input as far as that is still there.
  async openJob(id: string): Promise<void> {
    try {
      const job = await showJob(id);
      const name = job.labels?.find((label) => label.startsWith('file:'))?.slice(5) ?? `${job.id}.${job.input.format}`;
      const open = this.begin(name, { files: [], sha256: job.input.sha256 });
      this.showFile('Fetching the mesh …');
      await this.measureBefore();
      this.showFile();
      const { output: _, compression: __, features: ___, ...asked } = job.parameters;
      const run = newRun(++this.counter, chosenOf(job.parameters), asked);
      run.job = job;
      open.runs.push(run);
      if (job.state === 'succeeded') await this.choose('right', run);
      this.showRuns();
    } catch (error) {
      this.complain(error);
    }
  }

  async denoise(): Promise<void> {
    const open = this.open;
    if (!open || this.runButton.disabled) return;
    this.errors.replaceChildren();
    this.parameters.forgive();
    let chosen;
    try {
      chosen = this.parameters.parameters();
    } catch (error) {
      this.complain(error);
      return;
    }
    const run = newRun(++this.counter, chosen);
    open.runs.push(run);
    this.runButton.disabled = true;
    await execute(run, open.input, labelOf(open.name), () => this.open === open && this.showRuns());
    this.runButton.disabled = false;
    if (this.open !== open) return;
    if (run.error && run.error.problem.code !== 'canceled') this.complain(run.error);
    else if (run.job?.state === 'succeeded') {
      history.replaceState(null, '', `#job=${run.job.id}`);
      await this.choose('right', run).catch((error: unknown) => this.complain(error));
    }
  }

  /// The side before gets its curvature when somebody wants to see it.
  measureBefore(): Promise<void> {
    const open = this.open;
    if (!open || open.measured) return Promise.resolve();
    open.measuring ??= (async () => {
      try {
        const job = await measure(open.input, labelOf(open.name));
        const model = await this.modelOf(job);
        if (this.open !== open) return model.dispose();
        open.measured = true;
        this.showBefore(open, model);
        this.stage.rescale();
      } catch (error) {
        if (this.open === open) this.complain(error);
      } finally {
        open.measuring = null;
      }
    })();
    return open.measuring;
  }

  private begin(name: string, input: Input): Open {
    this.close();
    const open: Open = { name, input, before: null, measured: false, measuring: null, runs: [], left: null, right: null };
    this.open = open;
    this.counter = 0;
    this.errors.replaceChildren();
    this.showRuns();
    this.showResult();
    this.showCurl();
    return open;
  }

  /// Gives back what the mesh before held.
  private close(): void {
    this.stage.put('before', null, '');
    this.stage.put('after', null, '');
    this.open?.before?.dispose();
    for (const model of this.shown.values()) model.dispose();
    this.shown.clear();
    this.open = null;
  }

  private async inspect(open: Open): Promise<void> {
    const size = open.input.files.reduce((sum, file) => sum + file.size, 0);
    if (size > kMostInspected || this.open !== open) return;
    try {
      const found = await inspect(open.input.files);
      if (this.open === open) this.showFile(...inspectionLines(found));
    } catch (error) {
      if (this.open === open) this.complain(error);
    }
  }

  private showBefore(open: Open, model: Model): void {
    if (this.open !== open) return model.dispose();
    const first = !open.before;
    const old = open.before;
    open.before = model;
    if (!open.left) this.stage.put('before', model, 'Before');
    old?.dispose();
    if (first) this.stage.fit();
    if (!open.measured && this.stage.wantsCurvature()) void this.measureBefore();
  }

  private async modelOf(job: Job): Promise<Model> {
    const { library } = await this.view;
    return new library.Model(await library.loadFiles([new File([await result(job.id)], 'result.glb')]));
  }

  /// Shows a run, or the input, on one side. Only what is shown is kept in memory.
  private async choose(side: 'left' | 'right', run: Run | null): Promise<void> {
    const open = this.open!;
    const model = run ? (this.shown.get(run) ?? (await this.modelOf(run.job!))) : open.before;
    if (this.open !== open) return model?.dispose();
    if (run) this.shown.set(run, model!);
    open[side] = run;
    const same = open.left === open.right;
    this.stage.put('after', null, '');
    this.stage.put('before', same ? null : open.left ? this.shown.get(open.left)! : open.before, open.left ? captionOf(open.left) : 'Before');
    this.stage.put('after', open.right ? this.shown.get(open.right)! : same ? open.before : null, open.right ? captionOf(open.right) : 'Before');
    for (const [one, old] of this.shown) {
      if (one === open.left || one === open.right) continue;
      old.dispose();
      this.shown.delete(one);
    }
    this.stage.rescale();
    this.showRuns();
    this.showResult();
    if (this.stage.wantsCurvature() && !open.left) await this.measureBefore();
  }

  private showFile(...lines: string[]): void {
    const open = this.open;
    if (!open) {
      this.fileBox.replaceChildren(h('p', { class: 'faint' }, 'No mesh is open.'));
      this.runButton.disabled = true;
      return;
    }
    this.runButton.disabled = open.runs.some((run) => !run.error && !(run.job && isOver(run.job)));
    const size = open.input.files.reduce((sum, file) => sum + file.size, 0);
    const facts = open.before ? sizeWords(open.before.vertices, open.before.triangles) : '';
    this.fileBox.replaceChildren(
      h('h2', {}, open.name),
      h('p', {}, [facts, size ? bytes(size) : ''].filter(Boolean).join(' · ')),
      ...lines.map((line) => h('p', { class: 'faint' }, line)),
    );
  }

  private showRuns(): void {
    const open = this.open;
    this.runsBox.hidden = !open || open.runs.length === 0;
    const running = open?.runs.find((run) => !run.error && !(run.job && isOver(run.job)));
    this.stage.busy(running ? (stageWords[running.stage] ?? running.stage) : null, running?.progress);
    if (!open) return;
    const rows = open.runs.map((run) =>
      runRow(run, {
        show: () => void this.choose('right', run).catch((error: unknown) => this.complain(error)),
        cancel: () => (run.job ? void cancel(run.job.id).catch((error: unknown) => this.complain(error)) : run.stop.abort()),
        forget: () => void this.forget(open, run),
      }),
    );
    const choose = (side: 'left' | 'right', run: Run | null): void =>
      void this.choose(side, run).catch((error: unknown) => this.complain(error));
    this.runsBox.replaceChildren(
      h('h2', {}, 'Runs'),
      h('ul', { class: 'rows' }, ...rows),
      comparison(open.runs, open.left, open.right, choose),
    );
  }

  private async forget(open: Open, run: Run): Promise<void> {
    open.runs = open.runs.filter((one) => one !== run);
    if (open.left === run) await this.choose('left', null);
    if (open.right === run) await this.choose('right', null);
    this.showRuns();
    this.showResult();
  }

  private showResult(): void {
    const open = this.open;
    const run = open?.right;
    this.resultBox.hidden = !run?.job;
    if (!open || !run?.job) return;
    const lines = reportLines(run.job, this.shown.get(run)?.features ?? 0);
    const buttons = kFormats.map((format) => {
      const button = h('button', { type: 'button', textContent: format.label, data: { format: format.label } });
      button.onclick = () => void this.download(open, run, format, button);
      return button;
    });
    const copy = h('button', { type: 'button', class: 'quiet', textContent: 'Copy' });
    const text = h('pre', { id: 'curl', tabIndex: 0 });
    copy.onclick = () => void copyText(text.textContent ?? '', copy);
    this.resultBox.replaceChildren(
      h('h2', {}, captionOf(run)),
      h('div', { class: 'report', data: { test: 'report' } }, ...lines.map((line) => h('p', { class: line.note ? 'faint' : '' }, line.text))),
      h('h3', {}, 'Download'),
      h('div', { class: 'downloads' }, ...buttons),
      h('details', {}, h('summary', {}, 'This run for a shell'), copy, text),
    );
    this.showCurl();
  }

  private showCurl(): void {
    const place = document.getElementById('curl');
    const open = this.open;
    if (!place || !open?.right) return;
    const names = open.input.files.length > 0 ? open.input.files.map((file) => file.name) : [open.name];
    place.textContent = curlOf(names, open.right.asked, location.origin);
  }

  private async download(open: Open, run: Run, format: Format, button: HTMLButtonElement): Promise<void> {
    button.disabled = true;
    try {
      const { output, compression } = format;
      const job = await convert(run, open.input, labelOf(open.name), compression ? { output, compression } : { output });
      const name = `${open.name.replace(/\.[^.]*$/, '')}-denoised.${output}`;
      // A link to the result would need no memory, but could neither have this name nor send a key.
      const url = URL.createObjectURL(await result(job.id));
      h('a', { href: url, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(url), 60000);
    } catch (error) {
      this.complain(error);
    } finally {
      button.disabled = false;
    }
  }

  private async listJobs(): Promise<void> {
    try {
      const { jobs } = await listJobs();
      const rows = jobRows(
        jobs,
        (job) => void this.openJob(job.id),
        (job) => void (isOver(job) ? remove : cancel)(job.id).then(() => this.listJobs(), (error: unknown) => this.complain(error)),
      );
      this.jobList.replaceChildren(...(rows.length > 0 ? rows : [h('li', { class: 'faint' }, 'There are none.')]));
    } catch (error) {
      this.complain(error);
    }
  }

  private complain(error: unknown): void {
    const told = asApiError(error);
    const pointer = told instanceof ApiError ? told.problem.pointer : undefined;
    if (pointer && this.parameters.blame(pointer, told.problem.detail)) return;
    this.errors.replaceChildren(errorBox(told));
  }
}

/// A glTF before the files that it names.
function mainFirst(files: File[]): File[] {
  const rank = (file: File): number => (/\.gltf$/i.test(file.name) ? 0 : /\.(glb|ply|obj|stl|drc)$/i.test(file.name) ? 1 : 2);
  return [...files].sort((a, b) => rank(a) - rank(b));
}

/// Why a file is not shown: what loaders say of bytes helps nobody, what they say of files does.
function missingOr(error: unknown): string {
  const text = error instanceof Error ? error.message : '';
  return text.includes('drop it together') ? text : 'The viewer cannot read this file.';
}

async function copyText(text: string, button: HTMLButtonElement): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = 'Copied';
  } catch {
    // Without a secure connection there is no clipboard: select it for Ctrl-C.
    getSelection()?.selectAllChildren(byId('curl'));
    button.textContent = 'Selected: press Ctrl-C';
  }
}
