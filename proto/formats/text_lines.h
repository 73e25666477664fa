#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace fairway {

/// Longest line of a text format; a polygon of half a million corners fits.
inline constexpr std::size_t kMostLineBytes = std::size_t{1} << 22U;

/// Whether a backslash at the end of a line joins the next one to it (OBJ).
enum class Continuation { none, backslash };

/// Walks over the lines of untrusted text. Lines end with LF, CR LF or CR; the last one may be
/// without an end.
class LineReader {
 public:
  explicit LineReader(std::string_view text, Continuation continuation = Continuation::none)
      : text_(text), continuation_(continuation) {}

  /// Goes to the next line; false at the end and where a line is too long, see error().
  bool next();
  /// The line without its end.
  std::string_view line() const { return line_; }
  /// From 1.
  std::uint64_t number() const { return number_; }
  /// Where the next line begins.
  std::size_t offset() const { return at_; }
  /// too_large where a line has more than kMostLineBytes.
  const std::optional<Error>& error() const { return error_; }

 private:
  std::string_view text_;
  std::string_view line_;
  Continuation continuation_;
  std::size_t at_ = 0;
  std::uint64_t number_ = 0;
  std::uint64_t lines_taken_ = 0;
  std::optional<Error> error_;
};

/// Removes white space, then the word behind it from the front of `rest`; empty at the end.
std::string_view next_word(std::string_view& rest);
std::vector<std::string_view> words_of(std::string_view line);

/// A decimal number that is the whole word, with or without a sign. Nothing where it is not finite;
/// numbers too small for a double are 0.
std::optional<double> parse_real(std::string_view word);
std::optional<std::int64_t> parse_integer(std::string_view word);

/// The shortest text that reads back as the same value.
std::string shortest(float value);
std::string shortest(double value);

/// A text with some of its words replaced; everything else as it came.
class TextPatch {
 public:
  explicit TextPatch(std::string_view source);
  /// `word` is a view into the source, behind the last one replaced.
  void replace(std::string_view word, std::string_view text);
  void insert_behind(std::string_view word, std::string_view text);
  std::vector<std::byte> finish();

 private:
  void copy_until(const char* end);
  std::string_view source_;
  const char* at_;
  std::vector<std::byte> out_;
};

}  // namespace fairway
