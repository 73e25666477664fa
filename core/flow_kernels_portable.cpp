// The kernels for all processors.

#define FAIRWAY_KERNELS_NAMESPACE portable
#include "core/curvature_kernel_impl.h"
#include "core/flow_kernels_impl.h"
#include "core/system_kernels_impl.h"
