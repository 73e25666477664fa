// A run of the service on the mesh that is open.

import { ApiError, follow, kAside, submit, type Input, type Job, type Parameters } from './api';

/// What the page asks for besides what a person chose: all that can be shown, in a format it can show.
const kShown: Parameters = { features: true, output: 'glb' };

export interface Run {
  number: number;
  parameters: Parameters; ///< what a person chose, to call it by
  asked: Parameters; ///< all that makes its result what it is, but for the format
  stop: AbortController; ///< of its upload
  job: Job | null; ///< null until the service has it
  progress: number; ///< 0 to 1
  stage: string;
  error: ApiError | null;
}

export const newRun = (number: number, parameters: Parameters, asked: Parameters = parameters): Run => ({
  number,
  parameters,
  asked,
  stop: new AbortController(),
  job: null,
  progress: 0,
  stage: 'upload',
  error: null,
});

/// In a few words what is special about a run.
export function nameOf(parameters: Parameters): string {
  const words: string[] = [];
  for (const [name, value] of Object.entries(parameters)) {
    if (name === 'preset') words.unshift(String(value));
    else words.push(`${name.replaceAll('_', ' ')} ${typeof value === 'string' ? value.replaceAll('_', ' ') : JSON.stringify(value)}`);
  }
  return words.join(', ') || 'automatic';
}

export const captionOf = (run: Run): string => `Run ${run.number}: ${nameOf(run.parameters)}`;

/// Does a run to its end. `told` is called at each change.
export async function execute(run: Run, input: Input, label: string, told: () => void): Promise<void> {
  try {
    run.stage = 'upload';
    const sent = (fraction: number): void => {
      run.progress = fraction;
      told();
    };
    run.job = await submit(input, { ...run.asked, ...kShown }, [label], sent, run.stop.signal);
    run.progress = 0;
    run.job = await follow(run.job, (job, progress) => {
      run.job = job;
      run.stage = job.state === 'queued' ? 'queue' : (progress?.stage ?? run.stage);
      run.progress = progress?.fraction ?? run.progress;
      told();
    });
    if (run.job.problem) run.error = new ApiError(run.job.problem);
    input.sha256 ??= run.job.input.sha256;
  } catch (error) {
    run.error = asApiError(error);
  }
  told();
}

/// The mesh with its curvature as it is, for the side before.
export async function measure(input: Input, label: string): Promise<Job> {
  const job = await follow(await submit(input, { method: 'none', ...kShown }, [label, kAside]), () => undefined);
  if (job.problem) throw new ApiError(job.problem);
  return job;
}

/// The job whose result is a run's in another format; nothing else differs from what a person chose.
export async function convert(run: Run, input: Input, label: string, format: Parameters): Promise<Job> {
  const job = await follow(await submit(input, { ...run.asked, ...format }, [label, kAside]), () => undefined);
  if (job.problem) throw new ApiError(job.problem);
  return job;
}

export function asApiError(error: unknown): ApiError {
  if (error instanceof ApiError) return error;
  const detail = error instanceof Error ? error.message : String(error);
  return new ApiError({ title: 'The page met a problem', status: 0, detail, code: 'page' });
}

export const stageWords: Record<string, string> = {
  upload: 'Uploading',
  queue: 'Waiting in the queue',
  decode: 'Reading the file',
  topology: 'Finding neighbours',
  flow: 'Removing noise',
  curvature: 'Measuring curvature',
  encode: 'Writing the result',
};

