#pragma once

#include <span>
#include <string>
#include <string_view>

#include "proto/formats/bytes.h"

namespace fairway::test {

/// A reader of untrusted bytes and what it promises about any bytes at all. The same function runs
/// under libFuzzer and, over seeds and mutations of them, in the ordinary tests.
struct FuzzTarget {
  std::string_view name;
  /// Answers "", or a sentence about the promise that was broken.
  std::string (*run)(ByteSpan bytes);
};

std::span<const FuzzTarget> fuzz_targets();

/// Null where there is no such target.
const FuzzTarget* find_fuzz_target(std::string_view name);

// The runs behind the table.
std::string fuzz_glb(ByteSpan bytes);
std::string fuzz_gltf(ByteSpan bytes);
std::string fuzz_drc(ByteSpan bytes);
std::string fuzz_ply(ByteSpan bytes);
std::string fuzz_obj(ByteSpan bytes);
std::string fuzz_stl(ByteSpan bytes);
std::string fuzz_recognition(ByteSpan bytes);
std::string fuzz_parameters(ByteSpan bytes);
std::string fuzz_worker_order(ByteSpan bytes);
std::string fuzz_worker_event(ByteSpan bytes);
std::string fuzz_http_head(ByteSpan bytes);
std::string fuzz_connection(ByteSpan bytes);
std::string fuzz_multipart(ByteSpan bytes);

}  // namespace fairway::test
