// Operator new for programs that hold meshes: large blocks start at a huge page and ask for huge
// pages. A fault per 4 KiB page of fresh memory takes longer than most of what is computed with it.
// The default operators delete fit: all memory is malloc's.

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20U;

/// Nothing where there is no memory. Whole huge pages only: the rest of a block costs what it
/// holds.
void* allocate(std::size_t size, std::size_t alignment) {
  if (size < kHugePage) {
    return alignment <= alignof(std::max_align_t)
               ? std::malloc(size)
               : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  }
  void* block = nullptr;
  if (posix_memalign(&block, std::max(kHugePage, alignment), size) != 0) return nullptr;
  // Advice only: without huge pages it works as well, if slower.
  (void)madvise(block, size / kHugePage * kHugePage, MADV_HUGEPAGE);
  return block;
}

void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  for (;;) {
    if (void* block = allocate(size == 0 ? 1 : size, alignment)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate_or_throw(size, alignof(std::max_align_t));
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
