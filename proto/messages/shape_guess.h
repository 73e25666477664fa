#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "proto/messages/format.h"

namespace fairway {

/// Whether bytes without a magic are OBJ or STL. An ASCII STL begins with "solid". An OBJ is a text
/// whose first line that is no comment begins with one of OBJ's keywords. A binary STL has at 80 a
/// count above zero and behind it a first triangle of finite corners and a normal of length 0 or 1.
std::optional<Format> guess_shape(std::span<const std::byte> head);

}  // namespace fairway
