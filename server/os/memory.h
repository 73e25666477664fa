#pragma once

#include <cstddef>

namespace fairway {

/// For a process that lives for one job: memory comes from one heap, of which the first `bytes` ask
/// for huge pages, and what is freed is kept for the next allocation. A fault per fresh page of
/// 4 KiB takes longer than most of what is computed with it. Reserves address space only, at most
/// half of what RLIMIT_AS allows; without huge pages, or where nothing can be reserved, all works
/// as before. Call before the work, from the main thread.
void prepare_heap(std::size_t bytes);

/// The heap to prepare for a mesh file of this size, bytes.
std::size_t heap_estimate(std::size_t file_size);

}  // namespace fairway
