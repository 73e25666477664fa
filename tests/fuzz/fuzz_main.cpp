// libFuzzer's entry points for the target that the environment's FAIRWAY_FUZZ_TARGET names.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "proto/formats/glb.h"
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/targets.h"

// The names are the library's.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
// NOLINTEND(readability-identifier-naming)

namespace fairway::test {
namespace {

/// libFuzzer's own mutation, which knows what the comparisons in the code looked for.
std::vector<std::byte> with_library(ByteSpan bytes, std::size_t most) {
  std::vector<std::byte> out(bytes.begin(), bytes.end());
  out.resize(std::max(most, bytes.size()));
  out.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(out.data()), bytes.size(), most));
  return out;
}

/// A GLB with its JSON or BIN chunk mutated and its lengths put right, so that it gets past the
/// framing.
std::vector<std::byte> with_library_inside(const GlbParts& parts, std::size_t most,
                                           Random& random) {
  GlbParts changed = parts;
  std::vector<std::byte> chunk;
  if (parts.bin && !parts.bin->empty() && random() % 2 == 0) {
    chunk = with_library(*parts.bin, parts.bin->size());
    chunk.resize(parts.bin->size());
    changed.bin = ByteSpan(chunk);
  } else {
    chunk = with_library(as_bytes(parts.json), std::min(most, parts.json.size() + 64));
    changed.json = as_text(chunk);
  }
  auto out = build_glb(changed);
  return out ? *std::move(out) : std::vector<std::byte>();
}

std::vector<std::byte> next_input(ByteSpan bytes, std::size_t most, Random& random) {
  if (random() % 4 == 0) return mutated(bytes, random);
  const auto parts = parse_glb(bytes);
  if (!parts || random() % 8 == 0) return with_library(bytes, most);
  return with_library_inside(*parts, most, random);
}

const FuzzTarget& chosen_target() {
  const char* name = std::getenv("FAIRWAY_FUZZ_TARGET");
  const FuzzTarget* target = name == nullptr ? nullptr : find_fuzz_target(name);
  if (target == nullptr) {
    std::fprintf(stderr, "FAIRWAY_FUZZ_TARGET names no target\n");
    std::exit(2);
  }
  return *target;
}

}  // namespace
}  // namespace fairway::test

// NOLINTBEGIN(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fairway;
  static const test::FuzzTarget& target = test::chosen_target();
  const std::string defect = target.run({reinterpret_cast<const std::byte*>(data), size});
  if (!defect.empty()) {
    std::fprintf(stderr, "broken promise: %s\n", defect.c_str());
    std::abort();
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  using namespace fairway;
  test::Random random(seed);
  const ByteSpan bytes(reinterpret_cast<const std::byte*>(data), size);
  const std::vector<std::byte> out = test::next_input(bytes, most, random);
  if (out.empty() || out.size() > most) return size;
  std::memcpy(data, out.data(), out.size());
  return out.size();
}
// NOLINTEND(readability-identifier-naming)
