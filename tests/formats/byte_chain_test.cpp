#include "proto/formats/byte_chain.h"

#include <memory>

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

std::string text_of(const ByteChain& chain) {
  return std::string(as_text(chain.joined()));
}

}  // namespace

TEST_CASE("a chain is its pieces one after the other") {
  const std::string lasting = "view ";
  ByteChain tail;
  tail.append(std::string("of a chain"));
  ByteChain chain;
  chain.append_view(as_bytes(lasting));
  chain.append(std::string("text "));
  chain.append(std::vector<std::byte>(2, std::byte{'b'}));
  chain.append(tail);
  CHECK(text_of(chain) == "view text bbof a chain");
  CHECK(chain.size() == text_of(chain).size());
  CHECK(chain.pieces().front().data() == as_bytes(lasting).data());
}

TEST_CASE("zeros fill a chain up to a multiple of four") {
  for (std::size_t size = 0; size < 9; ++size) {
    ByteChain chain(std::vector<std::byte>(size, std::byte{1}));
    chain.align_to_four();
    std::vector<std::byte> expected(size, std::byte{1});
    expected.resize((size + 3) / 4 * 4);
    CHECK(chain.joined() == expected);
  }
}

TEST_CASE("what a chain keeps lives as long as its last copy") {
  auto owner = std::make_shared<const std::string>("kept");
  const std::weak_ptr<const std::string> watch = owner;
  ByteChain copy;
  {
    ByteChain chain;
    chain.append_view(as_bytes(*owner));
    chain.keep(std::move(owner));
    copy.append(chain);
  }
  CHECK(text_of(copy) == "kept");
  copy = ByteChain();
  CHECK(watch.expired());
}

}  // namespace fairway::test
