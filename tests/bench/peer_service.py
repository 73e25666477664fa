"""What else a mesh could be sent to: FastAPI, uvicorn and Open3D as Debian packages them.

Answers POST /v1/denoise with a GLB body by the mesh after Taubin's filter, as binary PLY (Open3D's
own GLB is not one that it reads again). No queue, no limits, no store, no curvature.
"""

import os
import socket
import sys
import tempfile

import open3d
import uvicorn
from fastapi import FastAPI, HTTPException, Request, Response
from fastapi.concurrency import run_in_threadpool

ITERATIONS = 10

app = FastAPI()


@app.get("/livez")
async def livez():
    return {"status": "alive"}


def taubin(upload: bytes) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "in.glb")
        target = os.path.join(folder, "out.ply")
        with open(source, "wb") as file:
            file.write(upload)
        mesh = open3d.io.read_triangle_mesh(source)
        if not mesh.has_triangles():
            raise HTTPException(422, "The upload is no mesh.")
        smooth = mesh.filter_smooth_taubin(number_of_iterations=ITERATIONS)
        if not open3d.io.write_triangle_mesh(target, smooth, write_ascii=False):
            raise HTTPException(500, "The result cannot be written.")
        with open(target, "rb") as file:
            return file.read()


@app.post("/v1/denoise")
async def denoise(request: Request):
    result = await run_in_threadpool(taubin, await request.body())
    return Response(result, media_type="model/ply")


def main():
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.bind(("127.0.0.1", 0))
    listener.listen()
    print(f"peer: listening on http://127.0.0.1:{listener.getsockname()[1]}", flush=True)
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", access_log=False))
    server.run(sockets=[listener])
    return 0


if __name__ == "__main__":
    sys.exit(main())
