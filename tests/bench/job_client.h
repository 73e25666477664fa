#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/triangle_mesh.h"
#include "tests/bench/kept_connection.h"

namespace fairway::bench {

using Bytes = std::vector<std::byte>;

/// GLB files of a noisy torus. No two are the same, so that no answer comes from the service's
/// memory of equal work, and all are the same work: one vertex is moved by a millionth.
class Uploads {
 public:
  /// About so many vertices.
  explicit Uploads(std::size_t vertices);

  /// Thread-safe.
  Bytes next();
  std::size_t vertices() const { return clean_.positions.size(); }

 private:
  const IndexedMesh clean_;
  std::mutex mutex_;
  std::size_t count_ = 0;
};

/// How long the parts of a job took that was submitted and followed, seconds.
struct FollowedJob {
  double accepted = 0.0;  ///< the upload, up to 202
  double done = 0.0;      ///< long polls, up to the state succeeded
  double fetched = 0.0;   ///< the result
  std::string timing;     ///< what the service says: Server-Timing

  double total() const { return accepted + done + fetched; }
};

/// POST /v1/jobs, long polls, GET of the result. Errors: those of the connection; unavailable
/// where the service refuses or the job fails.
Result<FollowedJob> follow_job(KeptConnection& connection, const Bytes& upload);

/// POST /v1/denoise; the answer is the mesh. `query`: "" or "?…". Errors: as follow_job().
Result<Reply> denoise_by(KeptConnection& connection, const Bytes& upload,
                         std::string_view query = {});

/// DELETE of the job that an answer was about, where it names one. Errors: as follow_job().
Result<void> forget_job(KeptConnection& connection, const Reply& answer);

}  // namespace fairway::bench
