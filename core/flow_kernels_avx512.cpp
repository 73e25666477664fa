// The kernels for AVX512 processors.

#define FAIRWAY_KERNELS_NAMESPACE avx512
#include "core/curvature_kernel_impl.h"
#include "core/flow_kernels_impl.h"
#include "core/system_kernels_impl.h"
