#include "tests/chaos/work.h"

#include <chrono>
#include <fstream>
#include <iterator>
#include <span>

#include <fcntl.h>
#include <fmt/format.h>

#include "server/os/child_process.h"
#include "server/os/file.h"
#include "server/os/sha256.h"
#include "tests/chaos/trials.h"
#include "tests/places.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::chaos {
namespace {

constexpr const char* kEndless = R"({"method":"anisotropic_prescribed","steps":10000})";

/// By the program itself, where nobody is killed.
std::string denoised(const std::string& mesh, const std::string& parameters) {
  const test::TemporaryDirectory directory;
  const auto in = directory.path() / "in.glb";
  const auto out = directory.path() / "out.glb";
  std::ofstream(in, std::ios::binary) << mesh;
  const auto null = open_file("/dev/null", O_RDWR);
  expect(static_cast<bool>(null), "/dev/null cannot be opened");
  auto tool = ChildProcess::spawn({test::program("fairway"),
                                   {"denoise", in.string(), out.string(), "--params", parameters},
                                   {},
                                   {null->get(), null->get(), null->get()}});
  expect(tool && tool->wait().code == 0, "the undisturbed run failed: " + parameters);
  std::ifstream file(out, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::string sha256_of(const std::string& bytes) {
  Sha256 hash;
  hash.update(std::as_bytes(std::span(bytes)));
  return hash.hex();
}

Workshop::Workshop() : small_mesh_(test::noisy_torus(20)), busy_mesh_(test::noisy_torus(60)) {}

Work Workshop::work(const std::string& mesh, const char* parameters) {
  // The angle makes it one of its kind.
  const double angle = 30.0 + static_cast<double>(++count_) * 0.001;
  Work work{mesh, fmt::format(fmt::runtime(parameters), angle), {}, 0.0};
  const auto began = std::chrono::steady_clock::now();
  work.sha256 = sha256_of(denoised(work.mesh, work.parameters));
  work.milliseconds = milliseconds_since(began);
  return work;
}

Work Workshop::small() {
  return work(small_mesh_, R"({{"steps":5,"feature_angle":{}}})");
}

Work Workshop::verbose() {
  return work(small_mesh_, R"({{"steps":60,"feature_angle":{}}})");
}

Work Workshop::busy() {
  return work(busy_mesh_,
              R"({{"method":"anisotropic_prescribed","steps":3000,"feature_angle":{}}})");
}

Work Workshop::endless() const {
  return {test::noisy_torus(300), kEndless, {}, 0.0};
}

}  // namespace fairway::chaos
