// POST /v1/inspect: like POST /v1/denoise, but nothing is stored.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <utility>

#include "server/fairwayd/api/api.h"
#include "server/fairwayd/uploads/upload.h"
#include "server/fairwayd/work/inspection_task.h"
#include "server/fairwayd/work/job_wait.h"

namespace fairway {

/// The queue is asked before the upload is read, and again when there is something to queue.
Result<std::shared_ptr<InspectionTask>> Api::line_up(const HttpRequest& request, BodySource& body) {
  if (auto checked = check_upload(request, UploadUse::inspection, options_.max_mesh_bytes);
      !checked) {
    return checked.error();
  }
  if (auto room = check_disk(blobs_, options_.min_free_bytes, request.content_length.value_or(0));
      !room) {
    return room.error();
  }
  if (auto room = check_queue(); !room) return room.error();
  auto upload =
      receive_upload(request, UploadUse::inspection, body, blobs_, options_.max_mesh_bytes);
  if (!upload) return upload.error();
  const auto queued = jobs_.queue_length();
  if (!queued) return queued.error();
  auto task = std::make_shared<InspectionTask>(
      std::move(upload->mesh), WorkerOrder{upload->format, std::move(upload->parameters),
                                           upload->files, Work::inspect, request.trace.trace_id});
  const std::size_t places = options_.queue_limit - std::min(*queued, options_.queue_limit);
  if (auto done = supervisor_.inspect(task, places); !done) return done.error();
  return task;
}

HttpResponse Api::inspect(const HttpRequest& request, BodySource& body) {
  const auto task = line_up(request, body);
  if (!task) return refuse_upload(task.error());
  while (true) {
    if (auto answer = (*task)->wait(kLookForClient, stop_)) {
      return *answer ? json_response(**answer) : refuse(answer->error());
    }
    if (!request.client_is_there()) {
      supervisor_.withdraw(*task);
      HttpResponse response = problem_response({ErrorCode::canceled, "The client hung up."});
      response.close = true;
      return response;
    }
    if (stop_.stop_requested()) {
      supervisor_.withdraw(*task);
      return problem_response(
          {ErrorCode::unavailable, "The server is stopping: send the mesh again."});
    }
  }
}

}  // namespace fairway
