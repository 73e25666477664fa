// Large surfaces in few triangles, for as long as the camera moves on machines that draw slowly.

type Answer = MessageEvent<{ id: number; corners: Uint32Array }>;

let worker: Worker | null = null;
let orders = 0;

/// The corners of about `triangles` triangles over the same vertices.
export function coarsen(positions: Float32Array, corners: Uint32Array, triangles: number): Promise<Uint32Array> {
  worker ??= new Worker(COARSE_WORKER, { type: 'module' });
  const id = ++orders;
  const made = worker;
  return new Promise((resolve, reject) => {
    const answered = (event: Answer): void => {
      if (event.data.id !== id) return;
      made.removeEventListener('message', answered);
      resolve(event.data.corners);
    };
    made.addEventListener('message', answered);
    made.addEventListener('error', () => reject(new Error('A surface cannot be simplified for moving.')), { once: true });
    made.postMessage({ id, positions, corners, triangles });
  });
}
