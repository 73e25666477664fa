#include "server/os/memory.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

namespace fairway {
namespace {

constexpr std::size_t kMebibyte = std::size_t{1} << 20U;
constexpr std::size_t kHugePage = 2 * kMebibyte;

std::size_t address_space_left_to_use() {
  rlimit limit = {};
  const bool limited = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return limited ? limit.rlim_cur / 2 : SIZE_MAX;
}

}  // namespace

std::size_t heap_estimate(std::size_t file_size) {
  // Plain files take some thirty times their size, compressed ones more; untouched memory is free.
  constexpr std::size_t kShare = 50;
  return std::clamp(file_size, kMebibyte, 80 * kMebibyte) * kShare;
}

void prepare_heap(std::size_t bytes) {
#ifndef FAIRWAY_SANITIZED  // sanitizers bring a malloc of their own
  constexpr int kGrowth = 16 * kMebibyte;
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_TOP_PAD, kGrowth);
  bytes = std::min(bytes, address_space_left_to_use());
  void* block = std::malloc(bytes);
  if (block == nullptr) return;
  const auto start = reinterpret_cast<std::uintptr_t>(block);
  const std::uintptr_t first = (start + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t last = (start + bytes) / kHugePage * kHugePage;
  // Advice only.
  if (first < last) (void)madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
  std::free(block);
#else
  (void)bytes;
#endif
}

}  // namespace fairway
