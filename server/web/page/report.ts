// What a run found and did, in words.

import type { FlowReport, Inspection, Job, SurfaceReport } from './api';
import { count, plural, short } from './dom';

const percent = (share: number): string => {
  const value = 100 * share;
  if (Math.abs(value) < 0.005) return '±0.00 %';
  return `${value > 0 ? '+' : '−'}${Math.abs(value).toFixed(2)} %`;
};

/// By what the noise was removed.
function wayOf(flow: FlowReport): string {
  if (flow.pass_band) return `by a low pass (band ${short(flow.pass_band)})`;
  if (flow.chosen_step) return `at strength ${short(flow.strength ?? 0)} (step ${flow.chosen_step} of its path)`;
  return `in ${plural(flow.steps_done, 'step')}`;
}

/// `chosen`: a person said how many steps or how strongly, so whether the noise is gone is for him to judge.
function sentenceOf(surface: SurfaceReport, chosen: boolean): string {
  const flow = surface.flow;
  const parts: string[] = [];
  if (flow.steps_done === 0) {
    parts.push(flow.noise > 0.001 ? `noise about ${short(flow.noise)} edge lengths; nothing was moved` : 'no noise found; left as it is');
  } else {
    const kind = flow.noise_kind === 'correlated' ? ' that neighbours share' : '';
    parts.push(
      `noise${kind} about ${short(flow.noise)} edge lengths, ${chosen ? 'treated' : 'removed'} ${wayOf(flow)}`,
      `vertices moved by ${short(flow.rms_displacement)} edge lengths on average, ${short(flow.max_displacement)} at most`,
    );
    if (surface.boundary_loops === 0 && flow.volume_change !== null) parts.push(`volume ${percent(flow.volume_change)}`);
    parts.push(`area ${percent(flow.area_change)}`);
    if (flow.flipped_faces > 0) parts.push(`${plural(flow.flipped_faces, 'face')} flipped`);
  }
  return `${parts.join('; ')}.`;
}

/// The report of a job as lines: of each surface, then notes.
export function reportLines(job: Job, features: number): { text: string; note?: boolean }[] {
  const report = job.report;
  if (!report) return [];
  const named = report.surfaces.length > 1;
  const lines: { text: string; note?: boolean }[] = [];
  for (const surface of report.surfaces.slice(0, 12)) {
    const sentence = sentenceOf(surface, (job.parameters.steps ?? job.parameters.strength) !== 'auto');
    lines.push({ text: named ? `${surface.name}: ${sentence}` : sentence[0]!.toUpperCase() + sentence.slice(1) });
    for (const note of surface.flow.notes) lines.push({ text: named ? `${surface.name}: ${note}` : note, note: true });
  }
  if (report.surfaces.length > 12) lines.push({ text: `… and ${count(report.surfaces.length - 12)} meshes more.`, note: true });
  if (features > 0) lines.push({ text: `${count(features)} feature vertices kept sharp.` });
  for (const note of report.notes) lines.push({ text: note, note: true });
  return lines;
}

/// What is in a file, before anything is done.
export function inspectionLines(found: Inspection): string[] {
  const components = found.surfaces.reduce((sum, surface) => sum + surface.components, 0);
  const loops = found.surfaces.reduce((sum, surface) => sum + surface.boundary_loops, 0);
  const noise = found.surfaces.filter((surface) => !surface.clean).map((surface) => surface.noise);
  const lines = [
    `${plural(components, 'component')}, ${loops === 0 ? 'closed' : plural(loops, 'boundary loop')}.`,
    noise.length === 0
      ? 'No noise was found: an automatic run leaves it as it is.'
      : `Noise of about ${short(Math.max(...noise))} edge lengths; an automatic run takes about ${seconds(found.estimate.seconds)}.`,
  ];
  for (const warning of found.warnings) lines.push(typeof warning === 'string' ? warning : warning.message);
  return lines;
}

export const seconds = (value: number): string => (value < 1 ? `${Math.max(1, Math.round(1000 * value))} ms` : `${value.toPrecision(2)} s`);
