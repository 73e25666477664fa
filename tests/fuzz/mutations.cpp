#include "tests/fuzz/mutations.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "proto/formats/glb.h"

namespace fairway::test {
namespace {

std::size_t below(Random& random, std::size_t limit) {
  return static_cast<std::size_t>(random() % std::max<std::size_t>(limit, 1));
}

void flip_bits(std::vector<std::byte>& bytes, Random& random) {
  for (std::size_t i = 0; i < 1 + below(random, 3); ++i) {
    bytes[below(random, bytes.size())] ^= std::byte(1U << below(random, 8));
  }
}

void overwrite_field(std::vector<std::byte>& bytes, Random& random) {
  constexpr std::array<std::uint32_t, 12> kFields = {
      0,      1,          2,          0x7F,       0xFF,       0xFFFF,
      0x8000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7F800000, 0x7FC00000};
  const std::uint32_t field = kFields[below(random, kFields.size())];
  const std::size_t size = std::min<std::size_t>(std::size_t{1} << below(random, 3), bytes.size());
  std::memcpy(bytes.data() + below(random, bytes.size() - size + 1), &field, size);
}

void cut_off(std::vector<std::byte>& bytes, Random& random) {
  bytes.resize(below(random, bytes.size()));
}

/// A span of the bytes, at most a quarter of them.
ByteSpan some_of(const std::vector<std::byte>& bytes, Random& random) {
  const std::size_t size = below(random, bytes.size() / 4 + 1);
  return ByteSpan(bytes).subspan(below(random, bytes.size() - size), size);
}

void take_out(std::vector<std::byte>& bytes, Random& random) {
  const ByteSpan gone = some_of(bytes, random);
  const auto first = bytes.begin() + (gone.data() - bytes.data());
  bytes.erase(first, first + static_cast<std::ptrdiff_t>(gone.size()));
}

void double_some(std::vector<std::byte>& bytes, Random& random) {
  const ByteSpan some = some_of(bytes, random);
  const std::vector<std::byte> copy(some.begin(), some.end());
  const auto at = static_cast<std::ptrdiff_t>(below(random, bytes.size()));
  bytes.insert(bytes.begin() + at, copy.begin(), copy.end());
}

void replace_number(std::vector<std::byte>& bytes, Random& random) {
  const std::string changed = with_other_number(as_text(bytes), random);
  const ByteSpan text = as_bytes(changed);
  bytes.assign(text.begin(), text.end());
}

void mutate(std::vector<std::byte>& bytes, Random& random) {
  using Way = void (*)(std::vector<std::byte>&, Random&);
  constexpr std::array<Way, 6> kWays = {flip_bits, overwrite_field, cut_off,
                                        take_out,  double_some,     replace_number};
  if (bytes.empty()) return;
  kWays[below(random, kWays.size())](bytes, random);
}

struct Number {
  std::size_t at;
  std::size_t size;
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::vector<Number> numbers_of(std::string_view text) {
  std::vector<Number> out;
  for (std::size_t at = 0; at < text.size();) {
    if (!is_digit(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && is_digit(text[end])) ++end;
    out.push_back({at, end - at});
    at = end;
  }
  return out;
}

}  // namespace

std::string with_other_number(std::string_view text, Random& random) {
  constexpr std::array<std::string_view, 14> kLimits = {"0",
                                                        "1",
                                                        "-1",
                                                        "3",
                                                        "255",
                                                        "65535",
                                                        "65536",
                                                        "2147483647",
                                                        "4294967295",
                                                        "4294967296",
                                                        "9007199254740993",
                                                        "18446744073709551615",
                                                        "1e308",
                                                        "0.5"};
  std::string out(text);
  const std::vector<Number> numbers = numbers_of(text);
  if (numbers.empty()) return out;
  const Number number = numbers[below(random, numbers.size())];
  const Number other = numbers[below(random, numbers.size())];
  std::string value(text.substr(other.at, other.size));
  if (random() % 2 == 0) value = kLimits[below(random, kLimits.size())];
  out.replace(number.at, number.size, value);
  return out;
}

std::vector<std::byte> mutated(ByteSpan seed, Random& random) {
  const auto parts = parse_glb(seed);
  if (!parts || random() % 2 == 0) {
    std::vector<std::byte> out(seed.begin(), seed.end());
    mutate(out, random);
    return out;
  }
  GlbParts changed = *parts;
  std::string json(parts->json);
  std::vector<std::byte> bin;
  if (!parts->bin || random() % 2 == 0) {
    json = with_other_number(json, random);
    changed.json = json;
  } else {
    bin.assign(parts->bin->begin(), parts->bin->end());
    mutate(bin, random);
    bin.resize(parts->bin->size());
    changed.bin = ByteSpan(bin);
  }
  auto out = build_glb(changed);
  return out ? *std::move(out) : std::vector<std::byte>(seed.begin(), seed.end());
}

}  // namespace fairway::test
