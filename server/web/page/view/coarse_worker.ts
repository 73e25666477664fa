// Simplifies surfaces beside the page: the corners of fewer triangles over the same vertices.

import { MeshoptSimplifier } from 'meshoptimizer/simplifier';

interface Order {
  id: number;
  positions: Float32Array;
  corners: Uint32Array;
  triangles: number; ///< wanted
}

addEventListener('message', async (event: MessageEvent<Order>) => {
  const { id, positions, corners, triangles } = event.data;
  await MeshoptSimplifier.ready;
  const wanted = 3 * triangles;
  let [made] = MeshoptSimplifier.simplify(corners, positions, 3, wanted, 1);
  if (made.length > 1.5 * wanted) [made] = MeshoptSimplifier.simplifySloppy(corners, positions, 3, null, wanted, 1);
  postMessage({ id, corners: made });
});
