#pragma once

#include <vector>

#include "proto/formats/bytes.h"
#include "proto/formats/meshopt_decoder.h"

namespace fairway {

/// The stream that decode_meshopt() turns back into `bytes`: attributes, or indices in their order.
/// Nothing is rounded. Empty where no stream holds such values: none at all, strides of attributes
/// that are no multiple of 4 up to 256, indices of one byte. There is no filter and no mode of
/// triangles, which would turn them.
std::vector<std::byte> encode_meshopt(ByteSpan bytes, const MeshoptLayout& layout);

}  // namespace fairway
