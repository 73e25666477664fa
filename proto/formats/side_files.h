#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "proto/formats/bytes.h"

namespace fairway {

/// Gives the bytes of a file that a document names, by its path below the document's folder: one or
/// more names joined by '/', none of them "." or "..". The bytes must outlive the Document. Empty:
/// there are no such files. Errors: io, and whatever the provider says.
using SideFiles = std::function<Result<ByteSpan>(const std::string& path)>;

/// The path that a relative URI means below the document's folder, percent escapes decoded. Error:
/// invalid_mesh for what names an address, an absolute path or a place outside the folder, has a
/// query or a broken escape, or control characters, backslashes or more than 1024 bytes.
Result<std::string> path_of_uri(std::string_view uri);

/// "image/png" and the like by the first bytes of an image; "" where they are not known.
std::string_view image_media_type(ByteSpan bytes);

}  // namespace fairway
