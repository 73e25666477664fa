#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "proto/messages/encoding.h"

namespace fairway::bench {

/// Bare libdraco: decodes `input` and encodes `result`, a mesh it has decoded before, sequentially
/// with the same bits and level. Unchecked, as a few lines of anybody's code would do it.
class DracoBaseline {
 public:
  DracoBaseline(std::span<const std::byte> input, std::span<const std::byte> result,
                const DracoOptions& options);
  ~DracoBaseline();
  DracoBaseline(const DracoBaseline&) = delete;
  DracoBaseline& operator=(const DracoBaseline&) = delete;

  /// Bytes of the encoded mesh.
  std::size_t run() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fairway::bench
