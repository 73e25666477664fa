#include "tests/bench/job_client.h"

#include <cmath>

#include <fmt/format.h>

#include "core/shapes.h"
#include "proto/formats/fresh_mesh.h"
#include "proto/messages/json.h"
#include "tests/bench/report.h"

namespace fairway::bench {
namespace {

constexpr double kNoise = 0.2;  // in mean edges
constexpr double kNudge = 1e-6;

const KeptConnection::Headers kUploadHeaders = {{"Content-Type", "model/gltf-binary"}};

IndexedMesh noisy_torus(std::size_t vertices) {
  const auto tube = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(vertices) / 2)));
  return with_normal_noise(torus(2 * tube, tube, 1.0, 0.4), kNoise, 1);
}

/// The answer, if its status is what it should be.
Result<Reply> expect(int status, Result<Reply> reply) {
  if (!reply || reply->status == status) return reply;
  constexpr std::size_t kEnough = 200;
  return Error{ErrorCode::unavailable, fmt::format("Status {}, not {}: {}", reply->status, status,
                                                   reply->body.substr(0, kEnough))};
}

/// Waits for its end.
Result<void> follow(KeptConnection& connection, const std::string& path, std::string tag) {
  while (true) {
    const auto reply = connection.ask("GET", path, {{"If-None-Match", tag}, {"Prefer", "wait=30"}});
    if (!reply) return reply.error();
    constexpr int kNotModified = 304;
    if (reply->status == kNotModified) continue;
    const auto job = parse_json(reply->body);
    if (!job || !job->contains("state")) {
      return Error{ErrorCode::unavailable, "The answer is no job document: " + reply->body};
    }
    const std::string state = (*job)["state"];
    if (state == "succeeded") return {};
    if (state != "queued" && state != "running") {
      return Error{ErrorCode::unavailable, "The job ended otherwise: " + reply->body};
    }
    tag = reply->header("etag");
  }
}

}  // namespace

Uploads::Uploads(std::size_t vertices) : clean_(noisy_torus(vertices)) {}

Bytes Uploads::next() {
  std::size_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = count_++;
  }
  Surface surface;
  surface.mesh = clean_;
  // A float holds a millionth of the torus's radius; a place takes a thousand of them.
  constexpr std::size_t kPlaces = 1000;
  surface.mesh.positions[0].z() += kNudge * static_cast<double>(number % kPlaces);
  surface.mesh.positions[1].z() += kNudge * static_cast<double>(number / kPlaces % kPlaces);
  return write_fresh_mesh(surface, {}, Format::glb, {})->bytes.joined();
}

Result<FollowedJob> follow_job(KeptConnection& connection, const Bytes& upload) {
  constexpr int kAccepted = 202;
  constexpr int kOk = 200;
  FollowedJob job;
  Result<Reply> posted = Reply();
  job.accepted = seconds_of([&] {
    posted = expect(kAccepted, connection.ask("POST", "/v1/jobs", kUploadHeaders, upload));
  });
  if (!posted) return posted.error();
  const std::string path = posted->header("location");
  Result<void> followed;
  job.done = seconds_of([&] { followed = follow(connection, path, posted->header("etag")); });
  if (!followed) return followed.error();
  Result<Reply> fetched = Reply();
  job.fetched = seconds_of([&] { fetched = expect(kOk, connection.ask("GET", path + "/result")); });
  if (!fetched) return fetched.error();
  job.timing = fetched->header("server-timing");
  return job;
}

Result<Reply> denoise_by(KeptConnection& connection, const Bytes& upload, std::string_view query) {
  constexpr int kOk = 200;
  const std::string path = fmt::format("/v1/denoise{}", query);
  return expect(kOk, connection.ask("POST", path, kUploadHeaders, upload));
}

Result<void> forget_job(KeptConnection& connection, const Reply& answer) {
  constexpr int kOk = 200;
  const std::string path = answer.header("location");
  if (path.empty()) return {};
  const auto forgotten = expect(kOk, connection.ask("DELETE", path));
  if (!forgotten) return forgotten.error();
  return {};
}

}  // namespace fairway::bench
