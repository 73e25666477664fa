#include "server/fairwayd/operations/canary.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <variant>

#include <unistd.h>

#include "proto/messages/json.h"
#include "server/os/event_flag.h"
#include "server/os/file.h"

namespace fairway {
namespace {

static_assert(std::endian::native == std::endian::little, "GLB is little endian");

// One corner stands out a little, so that the flow has something to move.
constexpr std::array<float, 18> kPositions = {1, 0,  0, -1, 0, 0,     0, 1, 0,
                                              0, -1, 0, 0,  0, 1.25F, 0, 0, -1};
constexpr std::array<std::uint16_t, 24> kIndices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                                    2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
constexpr std::uint32_t kMagic = 0x46546C67;  ///< "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

void append(std::string& to, std::uint32_t number) {
  std::array<char, sizeof number> bytes;
  std::memcpy(bytes.data(), &number, sizeof number);
  to.append(bytes.data(), bytes.size());
}

void append_chunk(std::string& to, std::uint32_t type, std::string content, char filler) {
  content.resize((content.size() + 3) / 4 * 4, filler);
  append(to, static_cast<std::uint32_t>(content.size()));
  append(to, type);
  to += content;
}

Json scene() {
  return Json::parse(R"({
    "asset": {"version": "2.0"},
    "buffers": [{"byteLength": 120}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 72, "target": 34962},
                    {"buffer": 0, "byteOffset": 72, "byteLength": 48, "target": 34963}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3",
                   "min": [-1, -1, -1], "max": [1, 1, 1.25]},
                  {"bufferView": 1, "componentType": 5123, "count": 24, "type": "SCALAR"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})");
}

Error as_error(const WorkerEnd& end) {
  if (const auto* failed = std::get_if<Failed>(&end)) return failed->error;
  if (const auto* death = std::get_if<WorkerDied>(&end)) return death->cause;
  return {ErrorCode::unavailable, "The server is stopping."};
}

/// Errors: the output is no GLB.
Result<void> check_output(int output) {
  std::array<char, 4> head{};
  if (::pread(output, head.data(), head.size(), 0) != static_cast<ssize_t>(head.size()) ||
      std::memcmp(head.data(), &kMagic, head.size()) != 0) {
    return Error{ErrorCode::internal, "The worker wrote no GLB."};
  }
  return {};
}

}  // namespace

std::string canary_glb() {
  std::string binary(sizeof kPositions + sizeof kIndices, '\0');
  std::memcpy(binary.data(), kPositions.data(), sizeof kPositions);
  std::memcpy(binary.data() + sizeof kPositions, kIndices.data(), sizeof kIndices);
  std::string chunks;
  append_chunk(chunks, kJsonChunk, dump_json(scene()), ' ');
  append_chunk(chunks, kBinaryChunk, std::move(binary), '\0');
  std::string glb;
  append(glb, kMagic);
  append(glb, 2);
  append(glb, static_cast<std::uint32_t>(12 + chunks.size()));
  return glb + chunks;
}

Result<void> run_canary(BlobStore& blobs, WorkerPool& workers, const WorkerLimits& limits,
                        const std::stop_token& stop) {
  auto input = blobs.create();
  if (!input) return input.error();
  auto output = blobs.create();
  if (!output) return output.error();
  auto never = EventFlag::create();
  if (!never) return never.error();
  const std::string glb = canary_glb();
  if (auto done = (*input)->append(std::as_bytes(std::span(glb))); !done) return done;
  auto parameters = parse_parameters(R"({"steps":2})");
  if (!parameters) return parameters.error();
  const WorkerTask task{(*input)->descriptor(), (*output)->descriptor(),
                        WorkerOrder{Format::glb, *std::move(parameters)}, limits};
  const WorkerWatch watch{[](const Progress&) {}, [](std::string_view) {},
                          [&stop] { return !stop.stop_requested(); }, *never};
  const auto end = run_worker(workers, task, watch);
  if (!end) return end.error();
  if (!std::holds_alternative<Finished>(*end)) return as_error(*end);
  return check_output((*output)->descriptor());
}

}  // namespace fairway
