// Chooses kernels of the linear systems for the processor at hand.

#include "core/system_kernels.h"

namespace fairway {

namespace portable {
const SystemKernels& linear_kernels();
}  // namespace portable
#ifdef FAIRWAY_X86_KERNELS
namespace avx2 {
const SystemKernels& linear_kernels();
}  // namespace avx2
namespace avx512 {
const SystemKernels& linear_kernels();
}  // namespace avx512
#endif

const SystemKernels& system_kernels(Isa isa) {
#ifdef FAIRWAY_X86_KERNELS
  if (isa == Isa::avx512) return avx512::linear_kernels();
  if (isa == Isa::avx2) return avx2::linear_kernels();
#endif
  (void)isa;
  return portable::linear_kernels();
}

}  // namespace fairway
