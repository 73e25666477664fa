// The colours of the service itself (proto/formats/vertex_colors.cpp): from blue by light grey to red on
// straight lines in L*a*b* (CIE 15, D65) with equal lightness on both sides.

type Triple = readonly [number, number, number];

const kMiddle: Triple = [94, 0, 0];
const kLow: Triple = [34, 8, -44];
const kHigh: Triple = [34, 50, 32];

const srgbOfLinear = (v: number): number => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);

function srgbOfLab([lightness, a, b]: Triple): Triple {
  const inverse = (t: number): number => (t > 6 / 29 ? t ** 3 : 3 * (6 / 29) ** 2 * (t - 4 / 29));
  const l = (lightness + 16) / 116;
  const x = 0.95047 * inverse(l + a / 500);
  const y = inverse(l);
  const z = 1.08883 * inverse(l - b / 200);
  const channel = (v: number): number => Math.round(255 * srgbOfLinear(Math.min(Math.max(v, 0), 1)));
  return [
    channel(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
    channel(-0.969266 * x + 1.8760108 * y + 0.041556 * z),
    channel(0.0556434 * x - 0.2040259 * y + 1.0572252 * z),
  ];
}

/// The colour of a value in [-1, 1]: sRGB, 0 to 255.
export function diverging(value: number): Triple {
  const t = Math.min(Math.abs(value), 1);
  const end = value < 0 ? kLow : kHigh;
  const mix = (i: 0 | 1 | 2): number => kMiddle[i] + t * (end[i] - kMiddle[i]);
  return srgbOfLab([mix(0), mix(1), mix(2)]);
}

/// `n` colours from -1 to 1, as RGBA bytes.
export function colourTable(n: number): Uint8Array {
  const table = new Uint8Array(4 * n);
  for (let i = 0; i < n; ++i) table.set([...diverging((2 * i) / (n - 1) - 1), 255], 4 * i);
  return table;
}
