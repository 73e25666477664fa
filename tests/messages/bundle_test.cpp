// Several files as one payload, whole and damaged.

#include "proto/messages/bundle.h"

#include <random>

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace fairway::test {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A payload of ten bytes with this directory behind it.
std::string with_directory(const std::string& directory, const std::string& magic = "FWBUNDLE",
                           unsigned version = 1, long longer = 0) {
  const auto u32 = [](auto value) {
    std::string out(4, '\0');
    for (unsigned i = 0; i < 4; ++i) {
      out[i] = static_cast<char>(static_cast<unsigned>(value) >> (8 * i) & 0xFFU);
    }
    return out;
  };
  return "0123456789" + directory + magic + u32(version) +
         u32(static_cast<long>(directory.size()) + longer);
}

const std::string kTwoFiles =
    R"({"mesh":1,"files":[{"name":"a","bytes":4},{"name":"b","bytes":6}]})";

std::string sample() {
  const std::vector<BundleEntry> entries = {
      {"scene.gltf", 2}, {"", 0}, {"sk\"in\\ \xC3\xA4/1.png", 3}};
  std::vector<BundleEntry> files = entries;
  files[1].name = "empty";
  return "{}png" + bundle_end(files, 0);
}

}  // namespace

TEST_CASE("a bundle gives back its files, as views of its bytes") {
  const std::string payload = sample();
  const auto bundle = Bundle::parse(bytes_of(payload));
  REQUIRE(bundle);
  REQUIRE(bundle->files().size() == 3);
  CHECK(bundle->mesh() == 0);
  CHECK(bundle->files()[0].name == "scene.gltf");
  CHECK(text_of(bundle->files()[0].bytes) == "{}");
  CHECK(bundle->files()[1].bytes.empty());
  CHECK(bundle->files()[2].name == "sk\"in\\ \xC3\xA4/1.png");
  CHECK(text_of(bundle->files()[2].bytes) == "png");
  CHECK(bundle->files()[2].bytes.data() == bytes_of(payload).data() + 2);
}

TEST_CASE("the largest bundle that can be written can be read") {
  std::vector<BundleEntry> files;
  for (std::size_t i = 0; i < kMaxBundleFiles; ++i) {
    files.push_back({std::string(kMaxBundleName - 1, '"') + static_cast<char>('a' + i), 0});
    REQUIRE(check_bundle_name(files.back().name));
  }
  const std::string payload = bundle_end(files, kMaxBundleFiles - 1);
  const auto bundle = Bundle::parse(bytes_of(payload));
  REQUIRE(bundle);
  CHECK(bundle->files().size() == kMaxBundleFiles);
}

TEST_CASE("every truncation of a bundle is refused, at both ends") {
  const std::string payload = sample();
  for (std::size_t size = 0; size < payload.size(); ++size) {
    CAPTURE(size);
    const std::string head = payload.substr(0, size);
    const std::string tail = payload.substr(payload.size() - size);
    CHECK_FALSE(Bundle::parse(bytes_of(head)));
    CHECK_FALSE(Bundle::parse(bytes_of(tail)));
  }
  CHECK_FALSE(Bundle::parse(bytes_of(payload + '\0')));
  CHECK_FALSE(Bundle::parse(bytes_of('\0' + payload)));
}

TEST_CASE("a bundle whose directory lies is refused") {
  REQUIRE(Bundle::parse(bytes_of(with_directory(kTwoFiles))));
  const auto file = [](const char* name, const char* bytes) {
    return fmt::format(R"({{"name":{},"bytes":{}}})", name, bytes);
  };
  const auto lie = [&](const std::string& mesh, const std::string& first,
                       const std::string& second) {
    return fmt::format(R"({{"mesh":{},"files":[{},{}]}})", mesh, first, second);
  };
  const std::string a = file(R"("a")", "4");
  const std::string b = file(R"("b")", "6");
  REQUIRE(Bundle::parse(bytes_of(with_directory(lie("0", a, b)))));
  std::string many;
  for (int i = 0; i < 17; ++i) many += fmt::format(R"(,{{"name":"{}","bytes":0}})", i);
  const std::string ten = file(R"("ten")", "10");
  for (const std::string& directory :
       {lie("2", a, b), lie("-1", a, b), lie("0.0", a, b), lie("\"0\"", a, b),
        lie("18446744073709551616", a, b), lie("0", a, a), lie("0", a, file(R"("b")", "5")),
        lie("0", a, file(R"("b")", "7")), lie("0", a, file(R"("b")", "-6")),
        lie("0", a, file(R"("b")", "6.0")), lie("0", a, file(R"("b")", "18446744073709551615")),
        lie("0", a, file(R"("b")", "18446744073709551612")), lie("0", a, file("6", "6")),
        // Their sum is right modulo 2^64.
        lie("0", file(R"("a")", "11"), file(R"("b")", "18446744073709551615")),
        lie("0", a, file(R"("")", "6")), lie("0", a, file(R"("\u0000")", "6")),
        lie("0", a, R"({"name":"b"})"), lie("0", a, R"({"name":"b","bytes":6,"at":0})"),
        lie("0", a, "[]"), lie("0", a, "null"), std::string(R"({"mesh":0,"files":[]})"),
        std::string(R"({"mesh":0,"files":{}})"), std::string(R"({"files":[]})"), std::string("[]"),
        std::string("{"), std::string(), std::string(10000, '['),
        R"({"mesh":0,"files":[)" + ten + many + "]}"}) {
    CAPTURE(directory.substr(0, 200));
    const auto bundle = Bundle::parse(bytes_of(with_directory(directory)));
    REQUIRE_FALSE(bundle);
    CHECK(bundle.error().code == ErrorCode::malformed_input);
  }
}

TEST_CASE("a bundle whose footer lies is refused") {
  for (const std::string& payload :
       {with_directory(kTwoFiles, "FWBUNDLF"), with_directory(kTwoFiles, "FWBUNDLE", 2),
        with_directory(kTwoFiles, "FWBUNDLE", 0), with_directory(kTwoFiles, "FWBUNDLE", 1, 1),
        with_directory(kTwoFiles, "FWBUNDLE", 1, -1), with_directory(kTwoFiles, "FWBUNDLE", 1, 11),
        with_directory(kTwoFiles, "FWBUNDLE", 1, -1000),
        with_directory(std::string(40000, ' ') + kTwoFiles)}) {
    CHECK_FALSE(Bundle::parse(bytes_of(payload)));
  }
}

TEST_CASE("whatever bytes change, a bundle is refused or its files stay within it") {
  const std::string good = sample();
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    std::string payload = good;
    for (auto flips = 1 + random() % 3; flips > 0; --flips) {
      payload[random() % payload.size()] = static_cast<char>(random() % 256);
    }
    const auto bundle = Bundle::parse(bytes_of(payload));
    if (!bundle) continue;
    std::size_t total = 0;
    for (const BundledFile& file : bundle->files()) total += file.bytes.size();
    REQUIRE(total < payload.size());
    REQUIRE(bundle->mesh() < bundle->files().size());
  }
}

TEST_CASE("a name of a bundled file is short, printable UTF-8") {
  for (const std::string& name :
       {std::string("a"), std::string("../../etc/passwd"), std::string("a b%20\"\\.bin"),
        std::string("\xC3\xA4\xF0\x9F\x98\x80"), std::string(kMaxBundleName, 'x')}) {
    CHECK(check_bundle_name(name));
  }
  for (const std::string& name :
       {std::string(), std::string(kMaxBundleName + 1, 'x'), std::string("a\nb"),
        std::string("a\0b", 3), std::string("\x7F"), std::string("\xFF"), std::string("\xC3"),
        std::string("\xC0\xAF"), std::string("\xED\xA0\x80")}) {
    CAPTURE(name);
    REQUIRE_FALSE(check_bundle_name(name));
    CHECK(check_bundle_name(name).error().code == ErrorCode::bad_request);
  }
}

}  // namespace fairway::test
