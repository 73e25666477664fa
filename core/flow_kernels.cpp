// Chooses kernels for the processor at hand.

#include "core/flow_kernels.h"

#include "core/curvature_kernel.h"

namespace fairway {

namespace portable {
const FlowKernels<float>& single_kernels();
const FlowKernels<double>& double_kernels();
template <class Real>
CurvatureKernel<Real> curvature_kernel();
}  // namespace portable
#ifdef FAIRWAY_X86_KERNELS
namespace avx2 {
const FlowKernels<float>& single_kernels();
const FlowKernels<double>& double_kernels();
template <class Real>
CurvatureKernel<Real> curvature_kernel();
}  // namespace avx2
namespace avx512 {
const FlowKernels<float>& single_kernels();
const FlowKernels<double>& double_kernels();
template <class Real>
CurvatureKernel<Real> curvature_kernel();
}  // namespace avx512
#endif

Isa best_isa() {
#ifdef FAIRWAY_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return Isa::avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return Isa::avx2;
#endif
  return Isa::portable;
}

const char* name_of(Isa isa) {
  switch (isa) {
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      return "avx512";
    case Isa::portable:
      break;
  }
  return "portable";
}

template <>
const FlowKernels<float>& flow_kernels<float>(Isa isa) {
#ifdef FAIRWAY_X86_KERNELS
  if (isa == Isa::avx512) return avx512::single_kernels();
  if (isa == Isa::avx2) return avx2::single_kernels();
#endif
  (void)isa;
  return portable::single_kernels();
}

template <>
const FlowKernels<double>& flow_kernels<double>(Isa isa) {
#ifdef FAIRWAY_X86_KERNELS
  if (isa == Isa::avx512) return avx512::double_kernels();
  if (isa == Isa::avx2) return avx2::double_kernels();
#endif
  (void)isa;
  return portable::double_kernels();
}

template <class Real>
CurvatureKernel<Real> curvature_kernel(Isa isa) {
#ifdef FAIRWAY_X86_KERNELS
  if (isa == Isa::avx512) return avx512::curvature_kernel<Real>();
  if (isa == Isa::avx2) return avx2::curvature_kernel<Real>();
#endif
  (void)isa;
  return portable::curvature_kernel<Real>();
}
template CurvatureKernel<float> curvature_kernel<float>(Isa isa);
template CurvatureKernel<double> curvature_kernel<double>(Isa isa);

}  // namespace fairway
