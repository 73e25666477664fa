#include "server/fairwayd/http/http_range.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

/// As it was written: "first-", "first-last" or "-suffix".
struct RangeSpec {
  std::optional<std::uint64_t> first;
  std::optional<std::uint64_t> last;  ///< without `first`: so many at the end
};

std::optional<RangeSpec> parse_spec(std::string_view text) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::string_view before = trim_blanks(text.substr(0, dash));
  const std::string_view after = trim_blanks(text.substr(dash + 1));
  const RangeSpec spec{digits_value(before), digits_value(after)};
  const bool broken = (!before.empty() && !spec.first) || (!after.empty() && !spec.last) ||
                      (!spec.first && !spec.last) ||
                      (spec.first && spec.last && *spec.first > *spec.last);
  if (broken) return std::nullopt;
  return spec;
}

/// Nothing where it lies beyond the end.
std::optional<ByteRange> resolve(const RangeSpec& spec, std::uint64_t bytes) {
  if (!spec.first) {
    if (*spec.last == 0) return std::nullopt;
    return ByteRange{bytes - std::min(*spec.last, bytes), bytes - 1};
  }
  if (*spec.first >= bytes) return std::nullopt;
  return ByteRange{*spec.first, std::min(spec.last.value_or(bytes - 1), bytes - 1)};
}

Error refused(std::string message) {
  return {ErrorCode::range_not_satisfiable, std::move(message)};
}

}  // namespace

Result<std::vector<ByteRange>> parse_range(std::string_view value, std::uint64_t bytes) {
  const std::vector<ByteRange> ignored;
  const std::size_t equals = value.find('=');
  if (equals == std::string_view::npos || !same_word(value.substr(0, equals), "bytes")) {
    return ignored;
  }
  const auto elements = split_field(value.substr(equals + 1), ',');
  if (elements.size() > kMaxRanges) {
    return refused(fmt::format("At most {} ranges are taken at once.", kMaxRanges));
  }
  std::vector<ByteRange> ranges;
  for (const std::string_view element : elements) {
    const auto spec = parse_spec(element);
    if (!spec) return ignored;
    const auto range = resolve(*spec, bytes);
    if (range) ranges.push_back(*range);
  }
  if (elements.empty()) return ignored;
  if (ranges.empty()) {
    return refused(fmt::format("The result has {} bytes: none of the ranges lies in it.", bytes));
  }
  const auto unordered = [](const ByteRange& a, const ByteRange& b) { return b.first <= a.last; };
  if (std::adjacent_find(ranges.begin(), ranges.end(), unordered) != ranges.end()) {
    return refused("Ranges must ascend and must not overlap.");
  }
  return ranges;
}

}  // namespace fairway
