#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/bytes.h"
#include "proto/formats/ply_header.h"
#include "proto/formats/text_lines.h"

namespace fairway {

/// Reads the values behind the header of an untrusted PLY one after the other.
class PlyValues {
 public:
  PlyValues(ByteSpan body, PlyEncoding encoding);

  /// Whether as many records as `element` claims can be in the bytes that are left. Errors:
  /// invalid_mesh (more records than bytes; no properties), malformed_input (the bytes are cut).
  Result<void> check_count(const PlyElement& element) const;

  /// In a text, records are lines: goes to the next one that has words. Error: malformed_input.
  Result<void> begin_record();
  /// Error: invalid_mesh where the line has more words.
  Result<void> end_record();

  /// The next value's bytes: as stored, or its word. Error: malformed_input where there are none.
  Result<ByteSpan> take(PlyType type);
  /// The next list's count; no list is longer than the bytes that are left. Errors:
  /// malformed_input, invalid_mesh.
  Result<std::uint64_t> take_count(PlyType type);
  /// Passes a scalar or a whole list.
  Result<void> skip(const PlyProperty& property);

  /// What `taken` stands for, exactly; nothing where it is not finite or not of the type.
  std::optional<double> value(ByteSpan taken, PlyType type) const;

  /// The word taken last, of a text.
  std::string_view last_word() const { return last_word_; }

  /// Bytes of the body that are behind.
  std::size_t offset() const;

 private:
  std::size_t remaining() const { return body_.size() - offset(); }
  Error cut() const;

  ByteSpan body_;
  PlyEncoding encoding_;
  std::size_t at_ = 0;  ///< of a binary body
  LineReader lines_;    ///< of a text
  std::string_view rest_;
  std::string_view last_word_;
};

/// `value` as a value of a real `type` reads back.
double as_type(double value, PlyType type);

/// Appends a value of a real type, or a whole number of type u8, to a binary body.
void append_ply_value(double value, PlyType type, PlyEncoding encoding,
                      std::vector<std::byte>& out);

/// The same as a word.
std::string ply_word(double value, PlyType type);

}  // namespace fairway
