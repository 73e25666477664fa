#include "server/fairwayd/work/worker_limits.h"

#include <catch2/catch.hpp>

#include "server/fairwayd/uploads/memory_estimate.h"

using namespace fairway;
using namespace std::chrono_literals;

TEST_CASE("a small plain mesh gets less memory than the server gives, a compressed one all of it") {
  const WorkerLimits server{std::uint64_t{4} << 30, 600s, 300s};
  for (const Format format : {Format::ply, Format::stl, Format::obj}) {
    CHECK(limits_for(server, format, 1000).address_space < std::uint64_t{1} << 30);
    CHECK(limits_for(server, format, std::uint64_t{1} << 30).address_space == server.address_space);
  }
  for (const Format format : {Format::glb, Format::gltf, Format::drc}) {
    CHECK(limits_for(server, format, 1000).address_space == server.address_space);
  }
}

TEST_CASE("what a mesh needs at most is above what it needs at least") {
  for (const Format format : {Format::ply, Format::stl, Format::obj}) {
    for (const std::uint64_t bytes : {std::uint64_t{0}, std::uint64_t{1} << 20}) {
      CHECK(*most_memory(format, bytes) > least_memory(format, bytes));
    }
  }
}

TEST_CASE("no limit of memory stays none") {
  CHECK(limits_for({0, 600s, 300s}, Format::stl, 1000).address_space == 0);
}

TEST_CASE("a job with less time gets less processor time") {
  CHECK(limits_for({0, 600s, 2s}, Format::glb, 1000).cpu == processor_time_within(2s));
  CHECK(limits_for({0, 5s, 300s}, Format::glb, 1000).cpu == 5s);
}
