#include "server/fairwayd/uploads/memory_estimate.h"

namespace fairway {
namespace {

/// Bytes of memory per byte of the file, below the least that was measured for each format
/// (`/usr/bin/time -f %M fairway denoise`, tori of 40 thousand and 980 thousand vertices).
std::uint64_t factor_of(Format format) {
  switch (format) {
    case Format::glb:
    case Format::gltf:
      return 1;
    case Format::drc:
      return 16;
    case Format::ply:
    case Format::stl:
      return 5;
    case Format::obj:
      return 6;
  }
  return 1;
}

/// Above what a process of any job takes, and what is measured per byte of the densest files there
/// are: polygons of two bytes a triangle (see DESIGN.md).
constexpr std::uint64_t kMostFloor = std::uint64_t{512} << 20U;
constexpr std::uint64_t kMostFactor = 1024;

}  // namespace

std::uint64_t least_memory(Format format, std::uint64_t bytes) {
  return bytes * factor_of(format);
}

std::optional<std::uint64_t> most_memory(Format format, std::uint64_t bytes) {
  switch (format) {
    case Format::ply:
    case Format::stl:
    case Format::obj:
      return kMostFloor + bytes * kMostFactor;
    case Format::glb:
    case Format::gltf:
    case Format::drc:
      break;
  }
  return std::nullopt;
}

}  // namespace fairway
