// Values of PLY, as text and binary of either byte order.

#include "proto/formats/ply_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace fairway {
namespace {

using Eight = std::array<std::byte, 8>;

template <class T>
double stored(const Eight& bytes) {
  return static_cast<double>(load<T>(bytes.data()));
}

/// `bytes` begin with a value in this machine's order.
double stored_value(const Eight& bytes, PlyType type) {
  switch (type) {
    case PlyType::i8:
      return stored<std::int8_t>(bytes);
    case PlyType::u8:
      return stored<std::uint8_t>(bytes);
    case PlyType::i16:
      return stored<std::int16_t>(bytes);
    case PlyType::u16:
      return stored<std::uint16_t>(bytes);
    case PlyType::i32:
      return stored<std::int32_t>(bytes);
    case PlyType::u32:
      return stored<std::uint32_t>(bytes);
    case PlyType::f32:
      return stored<float>(bytes);
    case PlyType::f64:
      break;
  }
  return stored<double>(bytes);
}

/// Whether an integer type holds this value.
bool holds(PlyType type, double value) {
  const int bits = 8 * static_cast<int>(size_of(type));
  const bool is_signed = type == PlyType::i8 || type == PlyType::i16 || type == PlyType::i32;
  const double end = std::ldexp(1.0, is_signed ? bits - 1 : bits);
  return value == std::floor(value) && value < end && value >= (is_signed ? -end : 0.0);
}

/// Fewest bytes of a record. In a text each word needs one, and one between two.
std::uint64_t least_size(const PlyElement& element, PlyEncoding encoding) {
  std::uint64_t size = 0;
  for (const PlyProperty& property : element.properties) {
    size +=
        encoding == PlyEncoding::ascii ? 2 : size_of(property.list_size.value_or(property.type));
  }
  return size;
}

}  // namespace

PlyValues::PlyValues(ByteSpan body, PlyEncoding encoding)
    : body_(body), encoding_(encoding), lines_(as_text(body)) {}

std::size_t PlyValues::offset() const {
  return encoding_ == PlyEncoding::ascii ? lines_.offset() : at_;
}

Error PlyValues::cut() const {
  return {ErrorCode::malformed_input,
          "The PLY ends before all its elements are there; send the whole file."};
}

Result<void> PlyValues::check_count(const PlyElement& element) const {
  if (element.count == 0) return {};
  if (element.properties.empty()) {
    return Error{ErrorCode::invalid_mesh, "An element of the PLY has no properties; remove it."};
  }
  if (element.count > remaining()) {
    return Error{ErrorCode::invalid_mesh,
                 fmt::format("The PLY claims {} records where {} bytes are left; correct its "
                             "header.",
                             element.count, remaining())};
  }
  const auto needed = checked_multiply(element.count, least_size(element, encoding_));
  // The last word of a text may be without anything behind it.
  const std::uint64_t spare = encoding_ == PlyEncoding::ascii ? 1 : 0;
  if (!needed || *needed > remaining() + spare) return cut();
  return {};
}

Result<void> PlyValues::begin_record() {
  if (encoding_ != PlyEncoding::ascii) return {};
  while (lines_.next()) {
    rest_ = lines_.line();
    std::string_view look = rest_;
    if (!next_word(look).empty()) return {};
  }
  return lines_.error() ? *lines_.error() : cut();
}

Result<void> PlyValues::end_record() {
  if (encoding_ != PlyEncoding::ascii || next_word(rest_).empty()) return {};
  return Error{ErrorCode::invalid_mesh,
               fmt::format("Line {} behind the PLY's header has more values than its element has "
                           "properties; correct the file.",
                           lines_.number())};
}

Result<ByteSpan> PlyValues::take(PlyType type) {
  if (encoding_ != PlyEncoding::ascii) {
    const std::size_t size = size_of(type);
    if (size > body_.size() - at_) return cut();
    at_ += size;
    return body_.subspan(at_ - size, size);
  }
  const std::string_view word = next_word(rest_);
  if (!word.empty()) {
    last_word_ = word;
    return as_bytes(word);
  }
  return Error{ErrorCode::malformed_input,
               fmt::format("Line {} behind the PLY's header has too few values; send the whole "
                           "file.",
                           lines_.number())};
}

Result<std::uint64_t> PlyValues::take_count(PlyType type) {
  const auto taken = take(type);
  if (!taken) return taken.error();
  const auto count = value(*taken, type);
  const std::size_t left = encoding_ == PlyEncoding::ascii ? rest_.size() : remaining();
  if (!count || *count < 0.0 || *count > static_cast<double>(left)) {
    return Error{ErrorCode::invalid_mesh,
                 fmt::format("A list of the PLY claims more values than the {} bytes that are "
                             "left; correct the file.",
                             left)};
  }
  return static_cast<std::uint64_t>(*count);
}

Result<void> PlyValues::skip(const PlyProperty& property) {
  std::uint64_t count = 1;
  if (property.list_size) {
    const auto claimed = take_count(*property.list_size);
    if (!claimed) return claimed.error();
    count = *claimed;
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    if (auto taken = take(property.type); !taken) return taken.error();
  }
  return {};
}

std::optional<double> PlyValues::value(ByteSpan taken, PlyType type) const {
  double out = 0.0;
  if (encoding_ == PlyEncoding::ascii) {
    const auto number = parse_real(as_text(taken));
    if (!number) return std::nullopt;
    out = is_real(type) ? as_type(*number, type) : *number;
  } else {
    Eight bytes{};
    std::copy(taken.begin(), taken.end(), bytes.begin());
    if (encoding_ == PlyEncoding::big_endian) {
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken.size()));
    }
    out = stored_value(bytes, type);
  }
  if (!std::isfinite(out) || (!is_real(type) && !holds(type, out))) return std::nullopt;
  return out;
}

double as_type(double value, PlyType type) {
  return type == PlyType::f32 ? static_cast<double>(static_cast<float>(value)) : value;
}

void append_ply_value(double value, PlyType type, PlyEncoding encoding,
                      std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  if (type == PlyType::u8) {
    append_value(out, static_cast<std::uint8_t>(value));
  } else if (type == PlyType::f32) {
    append_value(out, static_cast<float>(value));
  } else {
    append_value(out, value);
  }
  if (encoding == PlyEncoding::big_endian) {
    std::reverse(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end());
  }
}

std::string ply_word(double value, PlyType type) {
  return type == PlyType::f32 ? shortest(static_cast<float>(value)) : shortest(value);
}

}  // namespace fairway
