// What can be shown on a surface as colour.

export interface Quantity {
  id: string;
  label: string;
  attribute: string; ///< as the loader names the glTF attribute
  unit: string;
  help: string;
}

export const kQuantities: readonly Quantity[] = [
  {
    id: 'predominant',
    label: 'Predominant curvature',
    attribute: '_curvature_predominant',
    unit: '1/length',
    help: 'The principal curvature of larger magnitude, with its sign: red is convex, blue concave.',
  },
  {
    id: 'mean',
    label: 'Mean curvature',
    attribute: '_curvature_mean',
    unit: '1/length',
    help: '(k1 + k2) / 2: red bulges out, blue in.',
  },
  {
    id: 'gaussian',
    label: 'Gaussian curvature',
    attribute: '_curvature_gaussian',
    unit: '1/length²',
    help: 'k1 · k2: red is like a sphere, blue like a saddle, grey can be unrolled.',
  },
  {
    id: 'k1',
    label: 'k1, the largest',
    attribute: '_curvature_k1',
    unit: '1/length',
    help: 'The larger principal curvature, with its sign.',
  },
  {
    id: 'k2',
    label: 'k2, the smallest',
    attribute: '_curvature_k2',
    unit: '1/length',
    help: 'The smaller principal curvature, with its sign.',
  },
];

/// Values of a quantity in bins between -limit and limit, and their limit: what 99 % stay below.
export interface Distribution {
  limit: number;
  suggested: number; ///< what 95 % stay below: the limit that the service chooses for colours
  bins: Float32Array;
}

export function distributionOf(values: readonly Float32Array[], binCount = 96): Distribution {
  const total = values.reduce((sum, part) => sum + part.length, 0);
  // A sample is enough for quantiles; every value is counted in the bins.
  const stride = Math.max(1, Math.floor(total / 50000));
  const sizes: number[] = [];
  let seen = 0;
  for (const part of values) {
    for (let i = 0; i < part.length; ++i) if (seen++ % stride === 0) sizes.push(Math.abs(part[i]!));
  }
  sizes.sort((a, b) => a - b);
  const quantile = (q: number): number => sizes[Math.min(sizes.length - 1, Math.floor(q * sizes.length))] ?? 0;
  const suggested = quantile(0.95) || 1;
  const limit = Math.max(quantile(0.99), 1.6 * suggested);
  const bins = new Float32Array(binCount);
  for (const part of values) {
    for (let i = 0; i < part.length; ++i) {
      const at = Math.floor(((part[i]! + limit) / (2 * limit)) * binCount);
      if (at >= 0 && at < binCount) bins[at]! += 1;
    }
  }
  return { limit, suggested, bins };
}
