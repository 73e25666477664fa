// The same run for a shell.

import { hasKey, type Parameters } from './api';

/// In single quotes, as a shell takes it literally.
const quoted = (text: string): string => `'${text.replaceAll("'", `'\\''`)}'`;

const word = (text: string): string => (/^[A-Za-z0-9._/:-]+$/.test(text) ? text : quoted(text));

export function curlOf(files: string[], parameters: Parameters, server: string): string {
  const main = files[0] ?? 'mesh.glb';
  const dot = main.lastIndexOf('.');
  const out = `${main.slice(0, dot)}-denoised${main.slice(dot)}`;
  const lines = ['curl -sS --fail-with-body'];
  if (hasKey()) lines.push('-H "Authorization: Bearer $FAIRWAY_KEY"');
  files.forEach((name, i) => lines.push(`-F ${quoted(`${i === 0 ? 'mesh' : name}=@${name}`)}`));
  if (Object.keys(parameters).length > 0) lines.push(`-F ${quoted(`params=${JSON.stringify(parameters)}`)}`);
  lines.push(`${server}/v1/denoise`, `-o ${word(out)}`);
  return lines.join(' \\\n  ');
}
