// The kernels for all processors.

#define FAIRWAY_KERNELS_NAMESPACE portable
#include "core/flow_kernels_impl.h"
