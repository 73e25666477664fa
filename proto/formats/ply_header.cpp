// The header of PLY. Source: G. Turk, "The PLY Polygon File Format" (1994).

#include "proto/formats/ply_header.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "proto/formats/text_lines.h"

namespace fairway {
namespace {

constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20U;
constexpr std::size_t kMostElements = 256;
constexpr std::size_t kMostProperties = 1024;

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 16> kTypeNames = {{{"char", PlyType::i8},
                                                  {"int8", PlyType::i8},
                                                  {"uchar", PlyType::u8},
                                                  {"uint8", PlyType::u8},
                                                  {"short", PlyType::i16},
                                                  {"int16", PlyType::i16},
                                                  {"ushort", PlyType::u16},
                                                  {"uint16", PlyType::u16},
                                                  {"int", PlyType::i32},
                                                  {"int32", PlyType::i32},
                                                  {"uint", PlyType::u32},
                                                  {"uint32", PlyType::u32},
                                                  {"float", PlyType::f32},
                                                  {"float32", PlyType::f32},
                                                  {"double", PlyType::f64},
                                                  {"float64", PlyType::f64}}};

std::optional<PlyType> type_of(std::string_view name) {
  const auto* found = std::find_if(kTypeNames.begin(), kTypeNames.end(),
                                   [name](const TypeName& row) { return row.name == name; });
  if (found == kTypeNames.end()) return std::nullopt;
  return found->type;
}

/// Takes the lines of a header one after the other.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view text) : text_(text), lines_(text) {}
  Result<PlyHeader> read();

 private:
  Result<void> take(const std::vector<std::string_view>& words);
  Result<void> take_format(const std::vector<std::string_view>& words);
  Result<void> take_element(const std::vector<std::string_view>& words);
  Result<void> take_property(const std::vector<std::string_view>& words);
  Error error(std::string_view what, ErrorCode code = ErrorCode::malformed_input) const {
    return {code, fmt::format("PLY header, line {}: {}", lines_.number(), what)};
  }

  std::string_view text_;
  LineReader lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

Result<void> HeaderReader::take_format(const std::vector<std::string_view>& words) {
  if (words.size() != 3 || has_format_) return error("\"format\" stands once, with two words.");
  has_format_ = true;
  if (words[2] != "1.0") {
    return error("fairway reads version 1.0; export the mesh again.",
                 ErrorCode::unsupported_format);
  }
  if (words[1] == "ascii") {
    header_.encoding = PlyEncoding::ascii;
  } else if (words[1] == "binary_little_endian") {
    header_.encoding = PlyEncoding::little_endian;
  } else if (words[1] == "binary_big_endian") {
    header_.encoding = PlyEncoding::big_endian;
  } else {
    return error("the format is ascii, binary_little_endian or binary_big_endian.");
  }
  return {};
}

Result<void> HeaderReader::take_element(const std::vector<std::string_view>& words) {
  const auto count = words.size() == 3 ? parse_integer(words[2]) : std::nullopt;
  if (!count) return error("an element has a name and a count.");
  if (*count < 0) return error("a count is negative; correct it.", ErrorCode::invalid_mesh);
  if (header_.find(words[1]) != nullptr) {
    return error("an element stands twice; rename one.", ErrorCode::invalid_mesh);
  }
  if (header_.elements.size() == kMostElements) {
    return error("there are too many elements; remove some.", ErrorCode::invalid_mesh);
  }
  header_.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(*count), {}});
  return {};
}

Result<void> HeaderReader::take_property(const std::vector<std::string_view>& words) {
  if (header_.elements.empty()) return error("a property stands before any element.");
  PlyElement& element = header_.elements.back();
  const bool list = words.size() == 5 && words[1] == "list";
  if (words.size() != 3 && !list) return error("a property has a type and a name.");
  const auto type = type_of(words[words.size() - 2]);
  const auto size = list ? type_of(words[2]) : std::nullopt;
  if (!type || (list && !size)) return error("a type is none of PLY's; use float, int or uchar.");
  if (size && is_real(*size)) return error("the count of a list is an integer.");
  if (element.find(words.back())) {
    return error("a property stands twice; rename one.", ErrorCode::invalid_mesh);
  }
  if (element.properties.size() == kMostProperties) {
    return error("there are too many properties; remove some.", ErrorCode::invalid_mesh);
  }
  element.properties.push_back({std::string(words.back()), *type, size});
  return {};
}

Result<void> HeaderReader::take(const std::vector<std::string_view>& words) {
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return {};
  if (words[0] == "format") return take_format(words);
  if (words[0] == "element") return take_element(words);
  if (words[0] == "property") return take_property(words);
  return error("this is no line of a PLY header.");
}

Result<PlyHeader> HeaderReader::read() {
  if (!lines_.next() || words_of(lines_.line()) != std::vector<std::string_view>{"ply"}) {
    return error("the first line is \"ply\".");
  }
  const std::size_t first_end = lines_.line().size();
  header_.line_end = text_.substr(first_end, lines_.offset() - first_end);
  while (lines_.next() && lines_.offset() <= kMostHeaderBytes) {
    const auto words = words_of(lines_.line());
    if (!words.empty() && words[0] == "end_header") {
      if (!has_format_) return error("there is no \"format\".");
      // Where lines end with CR alone, a LF behind the last one is the first byte of data.
      const auto line_end = static_cast<std::size_t>(lines_.line().data() - text_.data()) +
                            lines_.line().size() + header_.line_end.size();
      header_.size = header_.line_end == "\r" ? std::min(line_end, text_.size()) : lines_.offset();
      return std::move(header_);
    }
    if (auto taken = take(words); !taken) return taken.error();
    const bool of_vertex = !header_.elements.empty() && header_.elements.back().name == "vertex";
    const bool counts = !words.empty() && (words[0] == "property" || words[0] == "element");
    if (of_vertex && counts) header_.vertex_end = lines_.offset();
  }
  return error("\"end_header\" is missing; send the whole file.");
}

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool is_real(PlyType type) {
  return type == PlyType::f32 || type == PlyType::f64;
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return std::nullopt;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [element](const PlyElement& e) { return e.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

Result<PlyHeader> read_ply_header(ByteSpan bytes) {
  return HeaderReader(as_text(bytes)).read();
}

}  // namespace fairway
