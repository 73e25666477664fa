// What the page asks of the service: proto/openapi.yaml says what it answers.

export interface Problem {
  title: string;
  status: number;
  detail: string;
  code: string;
  pointer?: string;
}

export class ApiError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail);
  }
}

export interface FlowReport {
  noise: number;
  step_size: number;
  steps_done: number;
  noise_kind?: 'none' | 'white' | 'correlated';
  chosen_step?: number;
  strength?: number;
  pass_band?: number;
  feature_angle: number;
  rms_displacement: number;
  max_displacement: number;
  mean_edge_length: number;
  volume_change: number | null;
  area_change: number;
  flipped_faces: number;
  notes: string[];
}

export interface SurfaceReport {
  name: string;
  vertices: number;
  faces: number;
  components: number;
  boundary_loops: number;
  flow: FlowReport;
}

export type Parameters = Record<string, unknown>;

export interface Job {
  id: string;
  state: 'queued' | 'running' | 'succeeded' | 'failed' | 'canceled' | 'expired';
  created: string;
  started?: string;
  finished?: string;
  queue_position?: number;
  cached?: boolean;
  labels?: string[];
  input: { bytes: number; format: string; sha256: string };
  parameters: Parameters;
  progress?: Progress;
  report?: { surfaces: SurfaceReport[]; notes: string[] };
  result?: { bytes: number; format: string; sha256: string };
  problem?: Problem;
}

export interface Progress {
  stage: string;
  step: number;
  of: number;
  fraction: number;
}

export interface Inspection {
  vertices: number;
  triangles: number;
  surfaces: { noise: number; clean: boolean; components: number; boundary_loops: number }[];
  estimate: { seconds: number };
  warnings: (string | { message: string })[];
}

export interface Methods {
  methods: { name: string; good_for: string; choose_when: string; equation: string }[];
  presets: { name: string; description: string; parameters: Parameters }[];
  parameters: { properties: Record<string, Schema> };
}

export interface Schema {
  type?: string;
  enum?: string[];
  anyOf?: Schema[];
  const?: unknown;
  default?: unknown;
  minimum?: number;
  maximum?: number;
  description?: string;
  items?: Schema;
  properties?: Record<string, Schema>;
  'x-unit'?: string;
}

/// A mesh as it is handed to the service: its files, the one that names the others first, or the
/// digest of an input that the service has.
export interface Input {
  files: File[];
  sha256?: string;
}

const kKey = 'fairway-key';
let askForKey: () => Promise<string | null> = async () => null;

/// Who is asked for a key where the service wants one.
export function onKeyWanted(ask: () => Promise<string | null>): void {
  askForKey = ask;
}

export const hasKey = (): boolean => !!sessionStorage.getItem(kKey);

export function setKey(key: string): void {
  if (key) sessionStorage.setItem(kKey, key);
  else sessionStorage.removeItem(kKey);
}

function authorization(): Record<string, string> {
  const key = sessionStorage.getItem(kKey);
  return key ? { Authorization: `Bearer ${key}` } : {};
}

const unreachable = (): ApiError =>
  new ApiError({
    title: 'The service does not answer',
    status: 0,
    detail: 'The connection failed. Check that fairwayd runs and that the network is there, then try again.',
    code: 'unreachable',
  });

function problemOf(text: string, status: number): ApiError {
  try {
    const problem = JSON.parse(text) as Problem;
    if (problem.detail) return new ApiError(problem);
  } catch {
    // Not from fairwayd: a proxy in front of it answered.
  }
  const detail = `The answer was ${status}, and not from fairwayd itself: look at what stands in front of it.`;
  return new ApiError({ title: 'Unexpected answer', status, detail, code: 'unexpected' });
}

/// A request that succeeds, or an ApiError. A key is asked for where one is wanted, once.
export async function call(path: string, init: RequestInit = {}, retry = true): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, { ...init, headers: { ...authorization(), ...init.headers } });
  } catch (error) {
    if (init.signal?.aborted) throw error;
    throw unreachable();
  }
  if (response.ok) return response;
  if (response.status === 401 && retry) {
    const key = await askForKey();
    if (key !== null) {
      setKey(key);
      return call(path, init, false);
    }
  }
  throw problemOf(await response.text(), response.status);
}

const json = async <T>(path: string, init?: RequestInit): Promise<T> => (await call(path, init)).json() as Promise<T>;

/// A form as the service takes it: the mesh, and the files it names under the names that it has for them.
async function formOf(files: File[]): Promise<FormData> {
  const [main, ...others] = files;
  const uris = main!.name.toLowerCase().endsWith('.gltf') ? await urisOf(main!) : [];
  const form = new FormData();
  form.append('mesh', main!, main!.name);
  others.forEach((file, i) => form.append(`file${i}`, file, uris.find((uri) => uri.split('/').pop() === file.name) ?? file.name));
  return form;
}

/// The last part of a URI, as a file is called.
export const fileNameOf = (uri: string): string => decodeURIComponent(uri.split('/').pop() ?? uri);

/// What a glTF names, decoded; nothing where it is none, which the service will say.
async function urisOf(main: File): Promise<string[]> {
  try {
    const scene = JSON.parse(await main.text()) as Record<'buffers' | 'images', { uri?: string }[] | undefined>;
    const named = [...(scene.buffers ?? []), ...(scene.images ?? [])].map((one) => one.uri ?? '');
    return named.filter((uri) => uri && !uri.startsWith('data:')).map(decodeURIComponent);
  } catch {
    return [];
  }
}

type Sent = (fraction: number) => void;

/// Sends a form and tells how much of it is gone. fetch cannot tell.
function send(path: string, form: FormData, sent?: Sent, stop?: AbortSignal): Promise<{ status: number; text: string }> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open('POST', path);
    for (const [name, value] of Object.entries(authorization())) request.setRequestHeader(name, value);
    request.upload.onprogress = (event) => event.lengthComputable && sent?.(event.loaded / event.total);
    request.onload = () => resolve({ status: request.status, text: request.responseText });
    request.onerror = () => reject(unreachable());
    request.onabort = () => reject(new ApiError({ title: 'Canceled', status: 0, detail: 'The upload was stopped.', code: 'canceled' }));
    stop?.addEventListener('abort', () => request.abort());
    request.send(form);
  });
}

async function upload<T>(path: string, files: File[], sent?: Sent, stop?: AbortSignal): Promise<T> {
  const form = await formOf(files);
  let answer = await send(path, form, sent, stop);
  if (answer.status === 401) {
    const key = await askForKey();
    if (key !== null) {
      setKey(key);
      answer = await send(path, form, sent, stop);
    }
  }
  if (answer.status < 200 || answer.status > 299) throw problemOf(answer.text, answer.status);
  return JSON.parse(answer.text) as T;
}

/// A label that the service takes for a job of this file.
export const labelOf = (name: string): string =>
  `file:${name.replaceAll(/[^A-Za-z0-9._:/@+=-]/g, '_')}`.slice(0, 100);

/// The label of jobs that the page does by the way: they are in no list.
export const kAside = 'page:aside';

/// Submits a job: by the digest of its input where the service still has that, else with the files.
export async function submit(
  input: Input,
  parameters: Parameters,
  labels: string[],
  sent?: Sent,
  stop?: AbortSignal,
): Promise<Job> {
  const query = new URLSearchParams({ params: JSON.stringify(parameters) });
  for (const label of labels) query.append('label', label);
  if (input.sha256) {
    try {
      return await json<Job>(`/v1/jobs?${query}&input=sha256:${input.sha256}`, { method: 'POST' });
    } catch (error) {
      const gone = error instanceof ApiError && [404, 410].includes(error.problem.status);
      if (!gone || input.files.length === 0) throw error;
    }
  }
  const job = await upload<Job>(`/v1/jobs?${query}`, input.files, sent, stop);
  input.sha256 = job.input.sha256;
  return job;
}

export const inspect = (files: File[]): Promise<Inspection> => upload<Inspection>('/v1/inspect', files);
export const methods = (): Promise<Methods> => json<Methods>('/v1/methods');
export const showJob = (id: string): Promise<Job> => json<Job>(`/v1/jobs/${id}`);
export const listJobs = (): Promise<{ jobs: Job[] }> => json<{ jobs: Job[] }>('/v1/jobs?limit=30');
export const cancel = (id: string): Promise<Response> => call(`/v1/jobs/${id}/cancel`, { method: 'POST' });
export const remove = (id: string): Promise<Response> => call(`/v1/jobs/${id}`, { method: 'DELETE' });
export const result = async (id: string): Promise<Blob> => (await call(`/v1/jobs/${id}/result`)).blob();

export const isOver = (job: Job): boolean => !['queued', 'running'].includes(job.state);

/// Follows a job to its end by its events; where they break off, by asking for it.
export async function follow(job: Job, told: (job: Job, progress?: Progress) => void): Promise<Job> {
  let last = job;
  let failures = 0;
  while (!isOver(last)) {
    try {
      for await (const event of eventsOf(last.id)) {
        failures = 0;
        if (event.name === 'state') last = JSON.parse(event.data) as Job;
        told(last, event.name === 'progress' ? (JSON.parse(event.data) as Progress) : undefined);
      }
      if (!isOver(last)) last = await showJob(last.id);
    } catch (error) {
      // A service that restarts keeps its jobs: wait for it, but not for ever.
      const temporary = error instanceof ApiError && [0, 429, 502, 503, 504].includes(error.problem.status);
      if (error instanceof ApiError && (!temporary || ++failures > 60)) throw error;
      await new Promise((resolve) => setTimeout(resolve, 1000));
      last = await showJob(last.id).catch(() => last);
    }
  }
  told(last);
  return last;
}

/// Server-sent events by fetch, because EventSource cannot send a key.
async function* eventsOf(id: string): AsyncGenerator<{ name: string; data: string }> {
  const response = await call(`/v1/jobs/${id}/events`);
  if (!response.body) return;
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = '';
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    text += value;
    for (let end = text.indexOf('\n\n'); end >= 0; end = text.indexOf('\n\n')) {
      const lines = text.slice(0, end).split('\n');
      text = text.slice(end + 2);
      const field = (name: string): string =>
        lines
          .filter((line) => line.startsWith(`${name}:`))
          .map((line) => line.slice(name.length + 1).trimStart())
          .join('\n');
      if (field('data')) yield { name: field('event'), data: field('data') };
    }
  }
}
