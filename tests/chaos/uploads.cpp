// The server dies while an upload comes in.
#include <thread>

#include <fmt/format.h>

#include "tests/chaos/arena.h"
#include "tests/chaos/scenarios.h"
#include "tests/service/support/raw_connection.h"

namespace fairway::chaos {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kArriveWithin{2000};
/// The last bytes of a part wait in memory until it is known that they are no boundary.
constexpr std::size_t kHeldBack = 256;

struct Request {
  std::string text;
  std::size_t mesh_at = 0;  ///< where the mesh begins in it
};

Request with_head(const std::string& type, const std::string& before, const std::string& mesh,
                  const std::string& after) {
  const std::string head = fmt::format(
      "POST /v1/jobs HTTP/1.1\r\nHost: t\r\nContent-Type: {}\r\nContent-Length: {}\r\n\r\n", type,
      before.size() + mesh.size() + after.size());
  return {head + before + mesh + after, head.size() + before.size()};
}

Request raw_request(const std::string& mesh) {
  return with_head("model/gltf-binary", "", mesh, "");
}

Request form_request(const std::string& mesh) {
  return with_head("multipart/form-data; boundary=frontier",
                   "--frontier\r\nContent-Disposition: form-data; name=\"mesh\"; "
                   "filename=\"a.glb\"\r\n\r\n",
                   mesh, "\r\n--frontier--\r\n");
}

/// Waits until the service has stored what was sent of the mesh.
void wait_for_bytes(const Arena& arena, std::size_t bytes) {
  const auto until = std::chrono::steady_clock::now() + kArriveWithin;
  while (arena.spooled_bytes() < bytes && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(milliseconds(1));
  }
}

}  // namespace

void kill_during_upload(Trials& trials, Workshop& workshop, std::size_t count) {
  run_in_arena(trials, {}, count, [&](Arena& arena, std::size_t i) {
    const Work work = workshop.small();
    const Request request = i % 2 == 0 ? raw_request(work.mesh) : form_request(work.mesh);
    const std::size_t cut = trials.random(1, request.text.size() - 1);
    test::RawConnection connection(arena.service().port());
    connection.send(std::string_view(request.text).substr(0, cut));
    const std::size_t of_mesh = cut > request.mesh_at ? cut - request.mesh_at : 0;
    if (of_mesh > kHeldBack) wait_for_bytes(arena, of_mesh - kHeldBack);
    trials.note("bytes of an upload stored when killed",
                static_cast<double>(arena.spooled_bytes()));
    arena.kill();
    arena.start();
    arena.expect_no_strangers();
    arena.expect_clean_disk();
    arena.submit(work);
    arena.expect_promises_kept();
  });
}

}  // namespace fairway::chaos
